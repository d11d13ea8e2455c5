#include "coppice/implicit/polygonize/polygonize.h"

#include <gtest/gtest.h>

#include <cstring>
#include <limits>
#include <map>
#include <set>

#include "coppice/base/check_fields.h"
#include "implicit/trees.h"

namespace coppice {
namespace {

/// Checks that every edge has one triangle on both sides, and the triangles around every vertex form one
/// ring.
void expect_closed_manifold(const TriMesh& s) {
    // Of edge (a, b): the third corner.
    std::map<std::pair<std::uint32_t, std::uint32_t>, std::uint32_t> next;
    for (const auto& t : s.triangles) {
        for (std::size_t i = 0; i < 3; ++i) {
            ASSERT_LT(t[i], s.positions.size());
            ASSERT_TRUE(next.insert({{t[i], t[(i + 1) % 3]}, t[(i + 2) % 3]}).second)
                << "an edge twice one way";
        }
    }
    // An arbitrary neighbour, and the valence.
    std::map<std::uint32_t, std::pair<std::uint32_t, std::uint32_t>> corner;
    for (const auto& [edge, third] : next) {
        ASSERT_TRUE(next.contains({edge.second, edge.first})) << "an open edge";
        corner[edge.first].first = edge.second;
        ++corner[edge.first].second;
    }
    ASSERT_EQ(corner.size(), s.positions.size()) << "a vertex without a triangle";
    for (const auto& [v, around] : corner) {
        std::uint32_t at = around.first, steps = 0;
        do {
            at = next.at({v, at});
            ASSERT_LE(++steps, around.second);
        } while (at != around.first);
        ASSERT_EQ(steps, around.second) << "two rings meet in a vertex";
    }
}

int euler(const TriMesh& s) {
    return static_cast<int>(s.positions.size()) - static_cast<int>(s.triangles.size() / 2);
}

double volume(const TriMesh& s) {
    double sum = 0;
    for (const auto& t : s.triangles) {
        sum += dot(Vec3d(s.positions[t[0]]), cross(Vec3d(s.positions[t[1]]), Vec3d(s.positions[t[2]]))) / 6;
    }
    return sum;
}

TEST(Polygonize, SphereHasItsVolumeAndRadius) {
    const SolidField field(sphere({1, 2, 3}, {.radius = 2}));
    const TriMesh s = polygonize(field, {.cell = 0.125f});
    expect_closed_manifold(s);
    EXPECT_EQ(euler(s), 2);
    const double exact = 4.0 / 3 * std::numbers::pi * 8;
    // An inscribed polyhedron of edges up to a tenth of the radius.
    EXPECT_NEAR(volume(s), exact, 0.005 * exact);
    EXPECT_LT(volume(s), exact);
    // The distance of vertices from the ends of their edges is at least a hundredth of these.
    for (const Vec3 p : s.positions)
        ASSERT_NEAR(length(p - Vec3{1, 2, 3}), 2, 0.011 * 0.125 * std::sqrt(3.0));
}

TEST(Polygonize, RefinementsReduceTheError) {
    const SolidField field(intersect(std::array{box({{-1, -1, -1}, {1, 1, 1}}, {.radius = 0.2f}),
                                                sphere({}, {.radius = 1.3f, .influence = 1.6f})}));
    std::array<double, 3> worst{};
    for (const int n : {0, 1, 2}) {
        const TriMesh s = polygonize(field, {.cell = 0.1f, .refinements = n * 3});
        expect_closed_manifold(s);
        std::vector<float> v(s.positions.size());
        field.values(s.positions, v);
        for (const float x : v)
            worst[static_cast<std::size_t>(n)] =
                std::max<double>(worst[static_cast<std::size_t>(n)], std::abs(x - 0.5f));
    }
    EXPECT_LT(worst[1], worst[0]);
    EXPECT_LE(worst[2], worst[1]);
}

TEST(Polygonize, TorusHasOneHandle) {
    const TriMesh s = polygonize(SolidField(circle({}, {1, 2, 3}, 2, {.radius = 0.5f})), {.cell = 0.1f});
    expect_closed_manifold(s);
    EXPECT_EQ(euler(s), 0);
    EXPECT_NEAR(volume(s), 2 * std::numbers::pi * 2 * std::numbers::pi * 0.25, 0.1);
}

TEST(Polygonize, RandomTreesAreClosedManifolds) {
    int drawn = 0;
    for (std::uint64_t seed = 0; seed < 30; ++seed) {
        SCOPED_TRACE(seed);
        TreeMaker maker(500 + seed);
        const SolidField field(maker.tree(3).solid);
        if (field.surface_bounds().empty()) continue;
        const TriMesh s = polygonize(field, {.cell = field.surface_bounds().diagonal() / 30});
        expect_closed_manifold(s);
        drawn += !s.triangles.empty();
    }
    EXPECT_GT(drawn, 15);
}

TEST(Polygonize, SkippingBlocksDoesNotAffectTheMesh) {
    for (std::uint64_t seed = 0; seed < 10; ++seed) {
        SCOPED_TRACE(seed);
        TreeMaker maker(600 + seed);
        const SolidField field(maker.tree(3).solid);
        const Box3 box = field.surface_bounds();
        if (box.empty()) continue;
        const float cell = box.diagonal() / 40;
        const TriMesh skipping = polygonize(field, {.cell = cell});
        const TriMesh all = polygonize(FieldRef(field), box, {.cell = cell});
        EXPECT_EQ(skipping.triangles.size(), all.triangles.size());
        EXPECT_NEAR(volume(skipping), volume(all), 0.02 * (1 + volume(all)));
    }
}

/// A ball that is only defined within the box of the requested region, and not within regions far from it.
struct BallInRegions {
    static constexpr float kRadius = 0.3f, kReach = 0.5f;
    std::vector<Box3> boxes;

    float level() const { return 0; }
    void sample(std::uint32_t region, std::span<const Vec3> points, std::span<FieldSample> out) const {
        for (std::size_t i = 0; i < points.size(); ++i) {
            const bool known =
                boxes.empty() || boxes.at(region).inflated(1e-5f).overlaps({points[i], points[i]});
            out[i] = {known ? kRadius - length(points[i]) : 1, {}};
        }
    }
};

TEST(Polygonize, RegionsMatchTheWholeBox) {
    const Box3 box{{-0.8f, -0.9f, -1}, {1.1f, 0.7f, 1}};
    const PolygonizeOptions options{.cell = 0.03f};
    BallInRegions field;
    const TriMesh all = polygonize(FieldRef(field), box, options);
    const float r = BallInRegions::kReach;
    // Two boxes that overlap: no block occurs twice.
    const std::array near{Box3{{-r, -r, -r}, {0.1f, r, r}}, Box3{{-0.1f, -r, -r}, {r, r, r}}};
    const PolygonizeRegions regions = regions_touching(box, near, options);
    ASSERT_EQ(regions.block.size(), regions.box.size());
    EXPECT_TRUE(std::is_sorted(regions.block.begin(), regions.block.end(), std::less_equal<>()));
    // Blocks are 0.24 m wide, so that the ball's box of 1 m touches 4 to 6 of about 8 on each side.
    EXPECT_GE(regions.block.size(), 4u * 4 * 4);
    EXPECT_LE(regions.block.size(), 6u * 6 * 6);
    for (const Box3& b : regions.box) EXPECT_TRUE(b.inflated(1e-4f).overlaps({{-r, -r, -r}, {r, r, r}}));
    field.boxes = regions.box;
    for (const unsigned threads : {1u, 2u, 7u}) {
        const TriMesh some = polygonize(FieldRef(field), box, regions, options, {.threads = threads});
        EXPECT_EQ(some.triangles, all.triangles);
        EXPECT_EQ(some.positions, all.positions);
    }
}

TEST(Polygonize, AcceptsEmptyAndOutsideRegions) {
    const BallInRegions field;
    const Box3 box{{-1, -1, -1}, {1, 1, 1}};
    const PolygonizeRegions none = regions_touching(box, {});
    EXPECT_TRUE(none.block.empty());
    EXPECT_TRUE(polygonize(FieldRef(field), box, none).triangles.empty());
    const std::array away{Box3{{3, 3, 3}, {4, 4, 4}}, Box3{{-4, -4, -4}, {-3, -3, -3}}, Box3{}};
    EXPECT_TRUE(regions_touching(box, away).block.empty());
    const std::array beyond{Box3{{-9, -9, -9}, {9, 9, 9}}};
    const PolygonizeRegions all = regions_touching(box, beyond);
    // 66 cells on each side with the margin: 9 blocks.
    EXPECT_EQ(all.block.size(), 9u * 9 * 9);
    EXPECT_EQ(all.block.back(), 9u * 9 * 9 - 1);
    EXPECT_THROW(polygonize(FieldRef(field), box, all, {.cell = 1}), InvalidInput);
    EXPECT_THROW(regions_touching(box, beyond, {.cell = 1e-5f}), InvalidInput);
}

/// Noise: the values of all nodes are independent.
struct Noise {
    float level() const { return 0.6f; }
    void sample(std::uint32_t, std::span<const Vec3> points, std::span<FieldSample> out) const {
        const CounterRandom random(1, 2);
        for (std::size_t i = 0; i < points.size(); ++i) {
            std::uint32_t bits[3];
            std::memcpy(bits, &points[i], sizeof bits);
            const double u = random.uniform(bits[0] + 0x9e37ull * bits[1] + 0x1234567ull * bits[2]);
            out[i] = {u < 0.01 ? std::numeric_limits<float>::quiet_NaN() : float(u), {}};
        }
    }
};

TEST(Polygonize, NoiseIsAClosedManifold) {
    const Noise noise;
    const TriMesh s = polygonize(FieldRef(noise), {{0, 0, 0}, {1, 1, 1}}, {.cell = 0.08f});
    expect_closed_manifold(s);
    EXPECT_GT(s.triangles.size(), 10000u);
    for (const auto& t : s.triangles) {
        const Vec3 a = s.positions[t[0]], b = s.positions[t[1]], c = s.positions[t[2]];
        ASSERT_GT(length(cross(b - a, c - a)), 0);
    }
}

/// Inside everywhere.
struct Full {
    float level() const { return 0; }
    void sample(std::uint32_t, std::span<const Vec3>, std::span<FieldSample> out) const {
        for (FieldSample& s : out) s = {1, {}};
    }
};

TEST(Polygonize, ClosesTheSurfaceAtTheBox) {
    const Full full;
    const TriMesh s = polygonize(FieldRef(full), {{0, 0, 0}, {1, 2, 3}}, {.cell = 0.125f});
    expect_closed_manifold(s);
    EXPECT_EQ(euler(s), 2);
    EXPECT_GT(volume(s), 6);
    EXPECT_LT(volume(s), 1.25 * 2.25 * 3.25);
}

TEST(Polygonize, IsBitIdenticalForAnyNumberOfThreads) {
    TreeMaker maker(9);
    const SolidField field(maker.tree(4).solid);
    const TriMesh one = polygonize(field, {}, {.threads = 1});
    ASSERT_FALSE(one.triangles.empty());
    for (const unsigned threads : {2u, 7u}) {
        const TriMesh more = polygonize(field, {}, {.threads = threads});
        EXPECT_EQ(one.triangles, more.triangles);
        EXPECT_EQ(one.positions, more.positions);
    }
}

TEST(Polygonize, EmptySolidIsAnEmptyMesh) {
    EXPECT_TRUE(
        polygonize(SolidField(intersect(std::array{sphere({}), sphere({9, 0, 0})}))).triangles.empty());
    EXPECT_TRUE(polygonize(FieldRef(SolidField(sphere({}))), Box3{}).triangles.empty());
}

TEST(Polygonize, RejectsInvalidOptionsAndBoxes) {
    const SolidField field(sphere({}));
    EXPECT_NO_THROW(check_fields(PolygonizeOptions{}, "polygonize"));
    EXPECT_THROW(polygonize(field, {.cell = 1e-5f}), InvalidInput);
    EXPECT_THROW(polygonize(field, {.cell = -1}), InvalidInput);
    EXPECT_THROW(polygonize(field, {.cell = std::numeric_limits<float>::infinity()}), InvalidInput);
    EXPECT_THROW(polygonize(field, {.refinements = -1}), InvalidInput);
    EXPECT_THROW(polygonize(FieldRef(field), {{0, 0, 0}, {Box3::kInfinity, 1, 1}}), InvalidInput);
}

/// A ball with a different radius in calls for one half of space: the value at a point depends on the others.
struct TwoMinded {
    float left, right;  ///< radii
    float level() const { return 0; }
    void sample(std::uint32_t, std::span<const Vec3> points, std::span<FieldSample> out) const {
        const float radius = points[0].x < -0.01f ? left : right;
        for (std::size_t i = 0; i < points.size(); ++i) out[i] = {radius - length(points[i]), {}};
    }
};

TEST(Polygonize, RejectsAFieldWithTwoValuesAtOnePoint) {
    const Box3 box{{-2, -2, -2}, {2, 2, 2}};
    for (const TwoMinded& field : {TwoMinded{1, 1.3f}, TwoMinded{1.3f, 1}}) {
        EXPECT_THROW(polygonize(FieldRef(field), box, {.cell = 0.1f}), InvalidInput);
        EXPECT_THROW(polygonize(FieldRef(field), box, {.cell = 0.1f}, {.threads = 1}), InvalidInput);
    }
    const TwoMinded sure{1, 1};
    expect_closed_manifold(polygonize(FieldRef(sure), box, {.cell = 0.1f}));
}

TEST(Polygonize, StopsWhenCancelled) {
    std::stop_source source;
    source.request_stop();
    EXPECT_THROW(polygonize(SolidField(sphere({})), {}, {.stop = source.get_token()}), Cancelled);
}

}  // namespace
}  // namespace coppice
