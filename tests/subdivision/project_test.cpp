#include "coppice/subdivision/project.h"

#include <gtest/gtest.h>

#include <cstring>
#include <functional>
#include <limits>

#include "coppice/base/error.h"
#include "described_options.h"
#include "subdivision/cages.h"
#include "subdivision/fields.h"

namespace coppice {
namespace {

TestField torus_field() {
    return {[](std::uint32_t, Vec3 p) {
        const Vec3 away = p - 3.0f * normalized(Vec3{p.x, p.y, 0});
        return compact(away);
    }};
}

// Two crossing cylinders, blended by adding their fields.
TestField cross_field() {
    return {[](std::uint32_t, Vec3 p) {
        const FieldSample a = compact({p.x, p.y, 0});
        const FieldSample b = compact({0, p.y, p.z});
        return FieldSample{a.value + b.value, a.gradient + b.gradient};
    }};
}

/// Returns the mean number of evaluations of the field per vertex.
double mean_evaluations(const ProjectReport& report) {
    return static_cast<double>(report.evaluations) / static_cast<double>(report.vertices);
}

// A refined cage with an anchor per vertex.
struct Scene {
    PatchRefinement patches;
    Buffer<Vec3> positions, anchors;
    std::vector<std::uint32_t> regions;
    std::vector<ClipPlane> clips;

    Scene(const Cage& cage, const std::function<Vec3(Vec3)>& anchor_of, int levels = 2)
        : patches(cage.quads, cage.vertex_count(), levels), regions(cage.quads.size(), 0) {
        std::vector<Vec3> cage_anchors;
        for (const Vec3& p : cage.points) cage_anchors.push_back(anchor_of(p));
        positions = patches.refine(cage.points);
        anchors = patches.refine(cage_anchors);
    }
    ProjectReport project(const TestField& field, const ProjectOptions& options = {}, unsigned threads = 1) {
        Context ctx;
        ctx.threads = threads;
        return coppice::project(positions, anchors, patches, {FieldRef(field), regions, clips}, options, ctx);
    }
};

Vec3 on_axis(Vec3 p) { return {0, 0, p.z}; }

ProjectOptions with(ProjectionMethod method) {
    ProjectOptions o;
    o.method = method;
    return o;
}

constexpr std::array kMethods = {ProjectionMethod::rays, ProjectionMethod::gradient};

TEST(Project, TubeHasItsRadius) {
    for (const ProjectionMethod method : kMethods) {
        for (const float start :
             {0.4f, 0.9f, 1.3f, 1.6f, 3.0f}) {  // 8 sides shrink to 0.9; the support ends at 1.5
            SCOPED_TRACE(std::string(name_of(method)) + " from " + std::to_string(start));
            Scene scene(tube_cage(6, 8, start, 1, false), on_axis);
            const ProjectReport report = scene.project(cylinder_field(), with(method));
            EXPECT_EQ(report.not_converged, 0u);
            EXPECT_EQ(report.vertices, scene.patches.vertex_count());
            for (const Vec3& p : scene.positions) EXPECT_NEAR(std::hypot(p.x, p.y), 1, 3e-4f);
            // From nearby, one step and an evaluation of its result; the longest step outward is 1.6 times
            // the distance.
            const bool near = start > 0.7f && start < 1.5f;
            EXPECT_LE(mean_evaluations(report), method == ProjectionMethod::gradient ? 7 : near ? 2.1 : 4);
        }
    }
}

// The plain step requires a gradient, and a few more steps than one on the value's root; it overshoots where
// the field is flat.
TEST(Project, NewtonStepConvergesFromNearby) {
    for (const float start : {0.7f, 0.9f, 1.3f}) {
        SCOPED_TRACE(start);
        Scene scene(tube_cage(6, 8, start, 1, false), on_axis);
        const ProjectReport report = scene.project(cylinder_field(), with(ProjectionMethod::newton));
        EXPECT_EQ(report.not_converged, 0u);
        for (const Vec3& p : scene.positions) EXPECT_NEAR(std::hypot(p.x, p.y), 1, 3e-4f);
        EXPECT_GT(mean_evaluations(report), 2.5);
        EXPECT_LE(mean_evaluations(report), 7);
    }
    Scene outside(tube_cage(6, 8, 3.0f, 1, false), on_axis);
    const Buffer<Vec3> before = outside.positions;
    const ProjectReport report = outside.project(cylinder_field(), with(ProjectionMethod::newton));
    EXPECT_EQ(report.not_converged, report.vertices);
    EXPECT_EQ(outside.positions, before);
}

TEST(Project, RaysPreserveTheirDirection) {
    Scene scene(shaken(tube_cage(6, 4, 1, 1, false), 0.1f), on_axis);
    const Buffer<Vec3> before = scene.positions;
    scene.project(cylinder_field());
    for (std::size_t v = 0; v < before.size(); ++v) {
        const Vec3 from = normalized(before[v] - scene.anchors[v]);
        const Vec3 to = normalized(scene.positions[v] - scene.anchors[v]);
        EXPECT_NEAR(distance(from, to), 0, 1e-5f);
    }
}

TEST(Project, MatchesSphereAndTorus) {
    for (const ProjectionMethod method : kMethods) {
        SCOPED_TRACE(name_of(method));
        const Vec3 center{0.05f, -0.1f, 0.08f};  // the anchors are off the centre
        Scene ball(hub_cage(5), [](Vec3) { return Vec3{}; });
        EXPECT_EQ(ball.project(sphere_field(center), with(method)).not_converged, 0u);
        for (const Vec3& p : ball.positions) EXPECT_NEAR(distance(p, center), 1, 1e-3f);
        Scene ring(grid_cage(12, 6, true), [](Vec3 p) { return 3.0f * normalized(Vec3{p.x, p.y, 0}); });
        EXPECT_EQ(ring.project(torus_field(), with(method)).not_converged, 0u);
        for (const Vec3& p : ring.positions) {
            EXPECT_NEAR(std::hypot(std::hypot(p.x, p.y) - 3, p.z), 1, 1e-3f);
        }
    }
}

TEST(Project, MatchesABlendOfTwoBranches) {
    for (const ProjectionMethod method : kMethods) {
        SCOPED_TRACE(name_of(method));
        Scene scene(tube_cage(5, 4, 1.2f, 1, false), [](Vec3 p) { return Vec3{0, 0, p.z}; });
        for (Vec3& p : scene.positions) p.z += 1.6f;  // starts in the crotch and leaves it along one branch
        for (Vec3& a : scene.anchors) a.z += 1.6f;
        const TestField field = cross_field();
        const ProjectReport report = scene.project(field, with(method));
        EXPECT_EQ(report.not_converged, 0u);
        for (const Vec3& p : scene.positions) EXPECT_NEAR(field.at(0, p).value, 1, 2e-3f);
    }
}

// A tube along z from 0 to 5 with a flat end: its last quad is the cap.
Scene flat_tube(int levels) {
    const Cage cage = tube_cage(6, 4, 1.2f, 1, true);
    Scene scene(
        cage,
        [](Vec3 p) {
            return Vec3{0, 0, std::min(4.0f, p.z)};
        },
        levels);
    scene.clips = {ClipPlane{{0, 0, 2}, 10, static_cast<std::uint32_t>(cage.quads.size()) - 1, 1}};
    return scene;
}

// 2 for the rim of the last cage quad, 1 inside, 0 elsewhere; from the refined quads alone.
std::vector<int> places_of_last_cap(const Scene& scene) {
    const Buffer<Quad> quads = scene.patches.quads();
    const std::size_t cap = quads.size() - (std::size_t{1} << (2 * scene.patches.levels()));
    std::vector<int> inside(scene.positions.size(), 0), outside = inside;
    for (std::size_t q = 0; q < quads.size(); ++q) {
        for (const std::uint32_t v : quads[q]) (q < cap ? outside : inside)[v] = 1;
    }
    for (std::size_t v = 0; v < inside.size(); ++v) inside[v] += inside[v] * outside[v];
    return inside;
}

TEST(Project, AFlatEndIsADiscWithASharpRim) {
    for (const ProjectionMethod method : kMethods) {
        for (int levels = 0; levels <= 4; ++levels) {
            SCOPED_TRACE(std::string(name_of(method)) + " at level " + std::to_string(levels));
            Scene scene = flat_tube(levels);
            const ProjectReport report = scene.project(cylinder_field(), with(method));
            const std::vector<int> place = places_of_last_cap(scene);
            const int rim = 4 << levels;
            EXPECT_EQ(std::count(place.begin(), place.end(), 2), rim);
            EXPECT_EQ(report.clipped,
                      static_cast<std::uint64_t>(rim + std::count(place.begin(), place.end(), 1)));
            EXPECT_EQ(report.vertices, scene.patches.vertex_count());
            for (std::size_t v = 0; v < place.size(); ++v) {
                const Vec3 p = scene.positions[v];
                const float out = std::hypot(p.x, p.y);
                EXPECT_TRUE(place[v] == 0 || std::abs(p.z - 5) < 1e-6f) << p.z;
                EXPECT_TRUE(place[v] != 2 || std::abs(out - 1) < 3e-4f) << out;
                EXPECT_TRUE(place[v] != 1 || out < 0.99f) << out;
            }
        }
    }
}

// The end of the tube is pressed inward from one side: the vertices within the rim move away.
TEST(Project, InnerVerticesOfAFlatEndRemainInsideTheRim) {
    const TestField field{[](std::uint32_t, Vec3 p) {
        const Vec3 away = Vec3{p.x > 0 ? 2 * p.x : p.x, p.y, 0};
        FieldSample s = compact(away);
        if (p.x > 0) s.gradient.x *= 2;
        return s;
    }};
    Scene scene = flat_tube(3);
    scene.project(field);
    const std::vector<int> place = places_of_last_cap(scene);
    float rim = 0, inside = 0;
    for (std::size_t v = 0; v < place.size(); ++v) {
        if (place[v] == 2) rim = std::max(rim, scene.positions[v].x);
        if (place[v] == 1) inside = std::max(inside, scene.positions[v].x);
    }
    EXPECT_LT(rim, 0.7f);
    EXPECT_LT(inside, rim);
}

TEST(Project, VertexWithoutASurfaceInReachIsUnchanged) {
    for (const ProjectionMethod method : kMethods) {
        SCOPED_TRACE(name_of(method));
        Scene scene(hub_cage(3), [](Vec3) { return Vec3{}; });
        const Buffer<Vec3> before = scene.positions;
        const ProjectReport report = scene.project(sphere_field({50, 0, 0}), with(method));
        EXPECT_EQ(report.anchors_outside, scene.patches.vertex_count());
        EXPECT_EQ(report.not_converged, scene.patches.vertex_count());
        EXPECT_EQ(scene.positions, before);
    }
}

TEST(Project, VertexWithAnOutsideAnchorFollowsTheGradient) {
    Scene scene(hub_cage(3), [](Vec3 p) { return p; });
    for (Vec3& p : scene.positions) p = 1.2f * normalized(p);
    for (std::size_t v = 0; v < scene.anchors.size(); ++v)
        scene.anchors[v] = scene.positions[v] * (1.45f / 1.2f);
    const ProjectReport report = scene.project(sphere_field({}));
    EXPECT_EQ(report.anchors_outside, scene.patches.vertex_count());
    EXPECT_EQ(report.not_converged, 0u);
    for (const Vec3& p : scene.positions) EXPECT_NEAR(length(p), 1, 1e-3f);
}

TEST(Project, VertexWithARayInsideTheSolidFollowsTheGradient) {
    Scene scene(grid_cage(6, 6, false), [](Vec3 p) { return p; });
    const TestField slab{[](std::uint32_t, Vec3 p) { return compact({0, 0, p.z}); }};
    for (Vec3& p : scene.positions) p.z = 0.8f;
    for (std::size_t v = 0; v < scene.anchors.size(); ++v)
        scene.anchors[v] = scene.positions[v] + Vec3{1, 0, 0};
    const ProjectReport report = scene.project(slab);
    EXPECT_EQ(report.anchors_outside, 0u);
    EXPECT_EQ(report.not_converged, 0u);
    for (const Vec3& p : scene.positions) EXPECT_NEAR(p.z, 1, 1e-3f);
}

TEST(Project, RayInsideAnUnboundedSolidIsLimited) {
    for (const ProjectionMethod method : kMethods) {
        SCOPED_TRACE(name_of(method));
        Scene scene(hub_cage(3), [](Vec3) { return Vec3{}; });
        const Buffer<Vec3> before = scene.positions;
        const TestField full{[](std::uint32_t, Vec3 p) { return FieldSample{2, normalized(-p) * 1e-6f}; }};
        const ProjectReport report = scene.project(full, with(method));
        EXPECT_EQ(report.not_converged, scene.patches.vertex_count());
        for (std::size_t v = 0; v < before.size(); ++v)
            EXPECT_LE(length(scene.positions[v]), 3.01f * length(before[v]));
    }
}

TEST(Project, IsFiniteForAnyField) {
    for (const ProjectionMethod method : kMethods) {
        for (std::size_t k = 0; k <= kNastySamples.size(); ++k) {
            SCOPED_TRACE(std::string(name_of(method)) + " " + std::to_string(k));
            Scene scene(hub_cage(3), [](Vec3) { return Vec3{}; });
            const ProjectReport report = scene.project(nasty_field(k), with(method));
            EXPECT_LE(report.max_evaluations, 12u);
            for (const Vec3& p : scene.positions) EXPECT_TRUE(is_finite(p) && length(p) < 10);
        }
    }
}

TEST(Project, VertexAtItsAnchorIsUnchanged) {
    for (const ProjectionMethod method : kMethods) {
        Scene scene(hub_cage(3), [](Vec3 p) { return p; });
        const Buffer<Vec3> before = scene.positions;
        EXPECT_EQ(scene.project(sphere_field({}), with(method)).evaluations, 0u);
        EXPECT_EQ(scene.positions, before);
    }
}

TEST(Project, NoneMovesNothing) {
    Scene scene(hub_cage(3), [](Vec3) { return Vec3{}; });
    const Buffer<Vec3> before = scene.positions;
    EXPECT_EQ(scene.project(sphere_field({}), with(ProjectionMethod::none)).evaluations, 0u);
    EXPECT_EQ(scene.positions, before);
}

TEST(Project, SamplesEachVertexInTheRegionOfItsOwner) {
    Scene scene(hub_cage(3), [](Vec3) { return Vec3{}; });
    for (std::size_t f = 0; f < scene.regions.size(); ++f)
        scene.regions[f] = static_cast<std::uint32_t>(f / 2);
    const TestField field{[](std::uint32_t region, Vec3 p) {
        const float radius = 1 + 0.1f * static_cast<float>(region);
        const FieldSample s = compact(p / radius);
        return FieldSample{s.value, s.gradient / radius};
    }};
    scene.project(field);
    std::vector<std::uint32_t> owned(scene.patches.max_owned());
    for (std::uint32_t f = 0; f < scene.regions.size(); ++f) {
        const std::uint32_t count = scene.patches.owned_vertices(f, owned);
        for (std::uint32_t k = 0; k < count; ++k) {
            EXPECT_NEAR(length(scene.positions[owned[k]]), 1 + 0.1f * static_cast<float>(f / 2), 1e-3f);
        }
    }
}

TEST(Project, RelaxationPreservesTheSurfaceAndEqualizesAreas) {
    const auto unevenness = [](int passes) {
        Scene scene(shaken(tube_cage(8, 8, 1, 0.8f, false), 0.15f), on_axis);
        ProjectOptions options;
        options.relax_passes = passes;
        EXPECT_EQ(scene.project(cylinder_field(), options).not_converged, 0u);
        for (const Vec3& p : scene.positions) EXPECT_NEAR(std::hypot(p.x, p.y), 1, 3e-4f);
        double sum = 0;
        double squares = 0;
        const Buffer<Quad> quads = scene.patches.quads();
        for (const Quad& q : quads) {
            const double area = length(cross(scene.positions[q[2]] - scene.positions[q[0]],
                                             scene.positions[q[3]] - scene.positions[q[1]]));
            sum += area;
            squares += area * area;
        }
        return squares * static_cast<double>(quads.size()) / (sum * sum);
    };
    EXPECT_LT(unevenness(5), unevenness(0));
}

TEST(Project, IsBitIdenticalForAnyNumberOfThreads) {
    for (const ProjectionMethod method : kMethods) {
        const auto run = [&](unsigned threads) {
            Scene scene(grid_cage(90, 40, true), [](Vec3 p) { return 3.0f * normalized(Vec3{p.x, p.y, 0}); });
            ProjectOptions options = with(method);
            options.relax_passes = 1;
            const ProjectReport report = scene.project(torus_field(), options, threads);
            return std::pair{scene.positions, report.evaluations};
        };
        const auto one = run(1);
        for (const unsigned threads : {2u, 7u}) {
            const auto many = run(threads);
            EXPECT_EQ(std::memcmp(one.first.data(), many.first.data(), one.first.size() * sizeof(Vec3)), 0);
            EXPECT_EQ(one.second, many.second);
        }
    }
}

TEST(Project, RejectsInvalidSizesAndOptions) {
    Scene scene(hub_cage(3), [](Vec3) { return Vec3{}; });
    EXPECT_THROW(scene.project(sphere_field({}), {.tolerance = 0}), InvalidInput);
    EXPECT_THROW(scene.project(sphere_field({}), {.max_evaluations = 0}), InvalidInput);
    const ClipPlane good{{0, 0, 1}, 0, 2, 3};
    const auto with_clips = [&](std::vector<ClipPlane> clips) {
        Scene cut = scene;
        cut.clips = std::move(clips);
        cut.project(sphere_field({}));
    };
    EXPECT_NO_THROW(with_clips({good}));
    EXPECT_THROW(with_clips({good, good}), InvalidInput);
    EXPECT_THROW(with_clips({{{0, 0, 1}, 0, 2, 0}}), InvalidInput);
    EXPECT_THROW(with_clips({{{0, 0, 1}, 0, 2, 5}}), InvalidInput);
    EXPECT_THROW(with_clips({{{0, 0, 1}, 0, 2, 0xffffffffu}}), InvalidInput);
    EXPECT_THROW(with_clips({{{0, 0, 0}, 0, 2, 3}}), InvalidInput);
    EXPECT_THROW(with_clips({{{0, std::numeric_limits<float>::quiet_NaN(), 1}, 0, 2, 3}}), InvalidInput);
    scene.regions.pop_back();
    EXPECT_THROW(scene.project(sphere_field({})), InvalidInput);
    scene.anchors.pop_back();
    EXPECT_THROW(scene.project(sphere_field({})), InvalidInput);
}

TEST(ProjectOptions, EveryMemberIsDescribedWithADefaultInRange) { test::expect_described<ProjectOptions>(); }

}  // namespace
}  // namespace coppice
