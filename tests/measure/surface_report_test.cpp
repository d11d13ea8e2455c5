#include "coppice/measure/surface_report.h"

#include <gtest/gtest.h>

#include <limits>
#include <optional>
#include <string>
#include <string_view>
#include <tuple>
#include <type_traits>

#include "coppice/base/error.h"
#include "measure/support.h"
#include "mesh/shapes.h"

namespace coppice {
namespace {

using namespace shapes;

Skeleton pole() { return Skeleton({kRoot, NodeId(0)}, {{0, 0, 0}, {0, 0, 10}}, {0.5f, 0.5f}); }

TEST(CheckSurface, ReportsAllParts) {
    const PolygonMesh m = capsule(16, 4, 0.5f, 0, 10);
    const Skeleton s = pole();
    const SurfaceReport r = check_surface(m, &s);
    EXPECT_TRUE(r.sound());
    EXPECT_EQ(r.topology.euler, 2);
    EXPECT_GT(r.shape.signed_volume, 0);
    ASSERT_TRUE(r.intersections && r.radius && r.axes);
    EXPECT_EQ(r.intersections->total, 0u);
    EXPECT_EQ(r.radius->all.n, m.positions.size());
    EXPECT_EQ(r.axes->missing, 0u);
    // 0.974 is the area of 16 sides divided by the area of their circle; the base is round but specified as
    // flat.
    ASSERT_TRUE(r.volume);
    EXPECT_TRUE(r.holds_volume());
    EXPECT_GT(r.volume->ratio(), 0.98);
    const SurfaceReport round = check_surface(m, &s, {.base = EndShape::round});
    EXPECT_NEAR(round.volume->ratio(), 0.974, 0.002);
}

TEST(CheckSurface, ReportsMissingVolume) {
    // Half of the pole, by its length.
    const Skeleton s = pole();
    const SurfaceReport r = check_surface(capsule(16, 4, 0.5f, 0, 5), &s);
    EXPECT_FALSE(r.holds_volume());
    EXPECT_GT(r.volume->missing_percent(), 40);
    EXPECT_EQ(r.axes->missing, 0u);
}

TEST(CheckSurface, CountsTheHandlesOfTheSurfaceAndOfTheSkeleton) {
    const Skeleton s = pole();
    EXPECT_EQ(check_surface(capsule(16, 4, 0.5f, 0, 10), &s).handles, (HandlesReport{0, 0}));
    const PolygonMesh ring = torus(32, 16, 0.2f, 1);
    EXPECT_EQ(check_surface(ring, &s).handles, (HandlesReport{1, 0}));
    EXPECT_EQ(check_surface(both(ring, capsule(16, 4, 0.1f, 5, 9)), &s).handles, (HandlesReport{1, 0}));
    EXPECT_FALSE(check_surface(tube(8, 2, 1, 1), &s).handles);  // open
    EXPECT_FALSE(check_surface(ring, nullptr).handles);
}

TEST(CheckSurface, OmitsUnrequestedParts) {
    const SurfaceReport r = check_surface(cube(), nullptr, {.intersections = false});
    EXPECT_FALSE(r.intersections || r.radius || r.axes || r.volume);
    EXPECT_TRUE(r.watertight() && r.holds_volume());
    const Skeleton s = pole();
    EXPECT_TRUE(check_surface(cube(), &s, {.intersections = false}).axes);
}

TEST(CheckSurface, UnsoundMeshIsAResult) {
    EXPECT_FALSE(check_surface(tube(8, 2, 1, 1), nullptr).sound());
    EXPECT_FALSE(check_surface(PolygonMesh{}, nullptr).sound());
    const Skeleton s = pole();
    EXPECT_EQ(check_surface(PolygonMesh{}, &s).axes->missing, 1u);
    EXPECT_EQ(check_surface(both(cube(), box({0.5f, 0.5f, 0.5f}, {1.5f, 1.5f, 1.5f})), nullptr)
                  .intersections->total,
              6u);
}

/// Returns the value of a boolean figure; nullopt if the report does not contain it.
std::optional<bool> flag(const SurfaceReport& report, std::string_view wanted) {
    std::optional<bool> found;
    visit_figures(report, [&](std::string_view name, const auto& value) {
        if constexpr (std::is_same_v<std::remove_cvref_t<decltype(value)>, bool>) {
            if (name == wanted) found = value;
        }
    });
    return found;
}

TEST(CheckSurface, SoundMeansWatertightWithoutSelfIntersections) {
    const PolygonMesh crossing = both(cube(), box({0.5f, 0.5f, 0.5f}, {1.5f, 1.5f, 1.5f}));
    for (const auto& [mesh, watertight, sound] :
         {std::tuple{cube(), true, true}, {crossing, true, false}, {tube(8, 2, 1, 1), false, false}}) {
        const SurfaceReport r = check_surface(mesh, nullptr);
        EXPECT_EQ(r.watertight(), watertight);
        EXPECT_EQ(r.sound(), sound);
        EXPECT_EQ(flag(r, "watertight"), watertight);
        EXPECT_EQ(flag(r, "sound"), sound);
    }
    // A search that stopped at its limit found intersections, regardless of the count.
    EXPECT_FALSE(check_surface(crossing, nullptr, {.max_intersections = 0}).sound());
}

TEST(CheckSurface, SoundIsUnknownWithoutASearchForSelfIntersections) {
    constexpr CheckOptions kSkip{.intersections = false};
    EXPECT_EQ(flag(check_surface(cube(), nullptr, kSkip), "sound"), std::nullopt);
    EXPECT_EQ(flag(check_surface(cube(), nullptr, kSkip), "watertight"), true);
    EXPECT_EQ(flag(check_surface(tube(8, 2, 1, 1), nullptr, kSkip), "sound"), false);
}

TEST(CheckSurface, RejectsInvalidInput) {
    PolygonMesh m = cube();
    m.positions[0].x = std::numeric_limits<float>::quiet_NaN();
    EXPECT_THROW(check_surface(m, nullptr), InvalidInput);
    EXPECT_THROW(check_surface(polygons({{}, {}, {}}, {{0, 1, 7}}), nullptr), InvalidInput);
    EXPECT_THROW(check_surface(cube(), nullptr, {.max_intersections = -1}), InvalidInput);
}

TEST(CheckSurface, AcceptsExtremeCoordinates) {
    constexpr float kMax = std::numeric_limits<float>::max();
    const Skeleton s = pole();
    EXPECT_TRUE(check_surface(box({-kMax, -kMax, -kMax}, {kMax, kMax, kMax}), &s).sound());
    EXPECT_TRUE(check_surface(box({0, 0, 0}, {1e-44f, 1e-44f, 1e-44f}), &s).sound());
    EXPECT_EQ(check_surface(box({1, 1, 1}, {1, 1, 1}), &s).shape.inverted_faces, 6u);
}

TEST(CheckSurface, ReportsAnIncompleteSearch) {
    const PolygonMesh m = both(cube(), box({0.5f, 0.5f, 0.5f}, {1.5f, 1.5f, 1.5f}));
    const SurfaceReport r = check_surface(m, nullptr, {.max_intersections = 2});
    EXPECT_EQ(r.intersections->total, 2u);
    EXPECT_FALSE(r.intersections->complete);
}

TEST(CheckSurface, IsBitIdenticalForAnyNumberOfThreads) {
    // Rough surfaces that intersect many times, large enough for many ranges.
    const PolygonMesh m =
        both(both(torus(60, 200, 0.51f, 2), tube(100, 100, 0.49f, 10)), capsule(80, 40, 2.2f, 1, 3));
    const Skeleton s({kRoot, NodeId(0), NodeId(1), NodeId(1)}, {{0, 0, 0}, {0, 0, 5}, {0, 0, 10}, {2, 0, 5}},
                     {0.5f, 0.5f, 0.5f, 0.2f});
    const SurfaceReport one = check_surface(m, &s, {}, {.threads = 1});
    EXPECT_GT(one.intersections->total, 100u);
    EXPECT_EQ(check_surface(m, &s, {}, {.threads = 2}), one);
    EXPECT_EQ(check_surface(m, &s, {}, {.threads = 7}), one);
}

TEST(CheckSurface, ReportsIncreasingProgress) {
    float last = 0;
    const Skeleton s = pole();
    check_surface(cube(), &s, {}, {.progress = [&](float f) {
                      EXPECT_GE(f, last);
                      last = f;
                  }});
    EXPECT_EQ(last, 1);
}

/// The names of all figures, with a dot for groups.
struct Names {
    std::string prefix;
    std::string* all;
    template <class T>
    void operator()(const std::string& name, const T& value) const {
        if constexpr (requires { visit_figures(value, *this); }) {
            visit_figures(value, Names{prefix + name + ".", all});
        } else {
            static_assert(std::is_arithmetic_v<T>);
            *all += prefix + name + '\n';
        }
    }
};

TEST(Figures, ContainEveryNameOnce) {
    const Skeleton s = pole();
    std::string all;
    visit_figures(check_surface(capsule(16, 4, 0.5f, 0, 10), &s), Names{"", &all});
    for (const char* name : {"sound\n",
                             "vertices\n",
                             "euler\n",
                             "open_edges\n",
                             "scaled_jacobian.p1\n",
                             "signed_volume\n",
                             "bending\n",
                             "face_angle_degrees.p95\n",
                             "fork_bending\n",
                             "fork_face_angle_degrees.n\n",
                             "intersections.local\n",
                             "radius_all.n\n",
                             "radius_regular.mean_abs\n",
                             "tip_reach.p99\n",
                             "segments_missing\n",
                             "axes.severed\n",
                             "tips_short\n",
                             "radius_areas.mean\n",
                             "volume.ratio\n",
                             "volume.missing_percent\n"}) {
        EXPECT_NE(all.find(name), std::string::npos) << name;
    }
    std::string bare;
    visit_figures(check_surface(cube(), nullptr), Names{"", &bare});
    EXPECT_EQ(bare.find("radius"), std::string::npos);
    EXPECT_NE(bare.find("intersections.total"), std::string::npos);
}

}  // namespace
}  // namespace coppice
