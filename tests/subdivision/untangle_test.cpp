#include "coppice/subdivision/untangle.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <atomic>
#include <cstring>
#include <functional>
#include <limits>

#include "coppice/base/error.h"
#include "coppice/mesh/shape.h"
#include "coppice/subdivision/project.h"
#include "described_options.h"
#include "subdivision/cages.h"
#include "subdivision/fields.h"

namespace coppice {
namespace {

Vec3 on_axis(Vec3 p) { return {0, 0, p.z}; }
Vec3 at_centre(Vec3) { return {}; }

// A refined cage on its field.
struct Scene {
    PatchRefinement patches;
    Buffer<Quad> quads;
    Buffer<Vec3> positions, anchors;
    std::vector<std::uint32_t> regions;
    std::vector<ClipPlane> clips;
    TestField field;

    Scene(const Cage& cage, Vec3 (*anchor_of)(Vec3), TestField field_, int levels = 2)
        : patches(cage.quads, cage.vertex_count(), levels),
          quads(patches.quads()),
          regions(cage.quads.size(), 0),
          field(std::move(field_)) {
        std::vector<Vec3> cage_anchors;
        for (const Vec3& p : cage.points) cage_anchors.push_back(anchor_of(p));
        positions = patches.refine(cage.points);
        anchors = patches.refine(cage_anchors);
    }
    void project() { coppice::project(positions, anchors, patches, {FieldRef(field), regions, clips}); }
    UntangleReport untangle(const UntangleOptions& options = {}, unsigned threads = 1) {
        Context ctx;
        ctx.threads = threads;
        return coppice::untangle({positions, anchors, quads}, patches, {FieldRef(field), regions, clips},
                                 options, ctx);
    }
    // Exchanges two adjacent vertices.
    void fold(std::size_t quad) { std::swap(positions[quads[quad][0]], positions[quads[quad][1]]); }

    // The faces that are bad by the definition, in double precision.
    std::uint64_t count_bad(double quality = 0.2) const {
        return static_cast<std::uint64_t>(std::count_if(quads.begin(), quads.end(), [&](const Quad& q) {
            const auto at = [&](std::size_t k) { return Vec3d(positions[q[k]]); };
            Vec3d outward;
            for (std::size_t k = 0; k < 4; ++k) outward += at(k) - Vec3d(anchors[q[k]]);
            const Vec3d normal = cross(at(2) - at(0), at(3) - at(1));
            return scaled_jacobian(q, positions) < quality ||
                   dot(normal, outward) < 0.05 * length(normal) * length(outward);
        }));
    }
};

Scene tube(int levels = 2) {
    Scene scene(tube_cage(12, 12, 1, 0.6f, false), on_axis, cylinder_field(), levels);
    scene.project();
    return scene;
}
Scene ball(int levels = 2) {
    Scene scene(hub_cage(3), at_centre, sphere_field(), levels);
    scene.project();
    return scene;
}

std::uint64_t differences(const Buffer<Vec3>& a, const Buffer<Vec3>& b) {
    std::uint64_t count = 0;
    for (std::size_t v = 0; v < a.size(); ++v)
        count += std::memcmp(&a[v], &b[v], sizeof(Vec3)) != 0 ? 1u : 0u;
    return count;
}

TEST(Untangle, FoldOnATubeIsRemovedAndTheSurfacePreserved) {
    for (int levels = 0; levels <= PatchRefinement::kMaxLevels; ++levels) {
        SCOPED_TRACE(levels);
        Scene scene = tube(levels);
        const Buffer<Vec3> clean = scene.positions;
        scene.fold(scene.quads.size() / 2 + scene.quads.size() / 40);
        const Buffer<Vec3> folded = scene.positions;
        const UntangleReport report = scene.untangle();
        EXPECT_GE(report.bad_before, 2u);
        EXPECT_EQ(report.bad_after, 0u);
        EXPECT_EQ(scene.count_bad(), 0u);
        EXPECT_GE(report.passes, 1u);
        EXPECT_EQ(report.moved, differences(folded, scene.positions));
        EXPECT_GE(report.moved, 2u);
        EXPECT_LE(report.moved, 80u * report.passes);  // local
        for (const Vec3& p : scene.positions) EXPECT_NEAR(std::hypot(p.x, p.y), 1, 2e-3f);
    }
}

TEST(Untangle, FoldsOnABallAreRemoved) {
    for (int levels = 1; levels <= 5; ++levels) {
        SCOPED_TRACE(levels);
        Scene scene = ball(levels);
        const std::size_t step = std::max<std::size_t>(1, scene.quads.size() / 7);
        for (std::size_t q = 0; q < scene.quads.size(); q += step) scene.fold(q);
        EXPECT_GT(scene.untangle().bad_before, 0u);
        EXPECT_EQ(scene.count_bad(), 0u);
        for (const Vec3& p : scene.positions) EXPECT_NEAR(length(p), 1, 5e-3f);
    }
}

TEST(Untangle, CleanMeshIsUnchanged) {
    for (int levels = 0; levels <= 4; ++levels) {
        SCOPED_TRACE(levels);
        for (Scene scene : {tube(levels), ball(levels)}) {
            ASSERT_EQ(scene.count_bad(), 0u);
            const Buffer<Vec3> before = scene.positions;
            EXPECT_EQ(scene.untangle(), UntangleReport{});
            EXPECT_EQ(differences(before, scene.positions), 0u);
        }
    }
}

TEST(Untangle, CountsBadFacesByTheirDefinition) {
    for (const auto& [name, cage] : cage_zoo()) {
        for (int levels = 0; levels <= 4; ++levels) {
            for (const float size : {1e-7f, 1.0f, 1e7f}) {
                SCOPED_TRACE(name + ", level " + std::to_string(levels) + ", size " + std::to_string(size));
                Scene scene(shaken(cage, 0.35f), at_centre, sphere_field(), levels);
                for (std::size_t q = 0; q < scene.quads.size(); q += 5) scene.fold(q);
                for (Vec3& p : scene.positions) p *= size;
                for (Vec3& a : scene.anchors) a *= size;
                for (const float quality : {0.05f, 0.2f, 0.6f}) {
                    const std::uint64_t expected = scene.count_bad(quality);
                    Scene copy = scene;
                    const UntangleReport report = copy.untangle({.passes = 1, .quality = quality});
                    EXPECT_EQ(report.bad_before, expected);
                    EXPECT_EQ(report.bad_after, copy.count_bad(quality));
                }
            }
        }
    }
}

TEST(Untangle, RevertsPassesThatDoNotHelp) {
    Scene scene = ball();
    for (Vec3& p : scene.positions) p = -p;  // inside out
    const Buffer<Vec3> before = scene.positions;
    const UntangleReport report = scene.untangle({.passes = 100});
    EXPECT_EQ(report.bad_before, scene.quads.size());
    EXPECT_EQ(report.bad_after, scene.quads.size());
    EXPECT_EQ(report.moved, 0u);
    EXPECT_GT(report.passes, 0u);
    EXPECT_LT(report.passes, 30u);
    EXPECT_EQ(differences(before, scene.positions), 0u);
}

TEST(Untangle, FoldsAreIndependentOfEachOther) {
    const auto unfolded = [](std::initializer_list<std::uint32_t> folds) {
        Scene scene = tube();
        for (const std::uint32_t v : folds) scene.fold(v);
        scene.untangle();
        return scene.positions;
    };
    const Buffer<Vec3> flat = tube().positions, first = unfolded({200}), both = unfolded({200, 1800});
    std::size_t moved = 0;
    for (std::size_t v = 0; v < flat.size(); ++v) {
        if (first[v] == flat[v]) continue;
        ++moved;
        EXPECT_EQ(first[v], both[v]);
    }
    EXPECT_GT(moved, 0u);
    EXPECT_NE(first, both);
}

TEST(Untangle, PassesZeroDoesNothing) {
    Scene scene = tube();
    scene.fold(1000);
    const Buffer<Vec3> before = scene.positions;
    EXPECT_EQ(scene.untangle({.passes = 0}), UntangleReport{});
    EXPECT_EQ(differences(before, scene.positions), 0u);
}

TEST(Untangle, FlatEndRemainsFlatAndItsRimRound) {
    constexpr int kLevels = 2;
    Scene scene(
        tube_cage(7, 4, 1.2f, 1, true),
        [](Vec3 p) {
            return Vec3{0, 0, std::min(5.0f, p.z)};
        },
        cylinder_field(), kLevels);
    constexpr float kPlane = 6;
    scene.clips = {ClipPlane{{0, 0, 2}, 2 * kPlane, static_cast<std::uint32_t>(scene.regions.size()) - 1, 1}};
    scene.project();
    const std::size_t cap = scene.quads.size() - (std::size_t{1} << (2 * kLevels));
    const auto on_plane = [&](Vec3 p) { return std::abs(p.z - kPlane) < 1e-4f; };
    const auto radius = [](Vec3 p) { return std::hypot(p.x, p.y); };
    scene.fold(cap + 5);                      // in the middle
    scene.fold(cap + 1);                      // at the rim
    scene.fold(cap - (8u << (2 * kLevels)));  // on the tube
    const Buffer<Vec3> before = scene.positions;
    const UntangleReport report = scene.untangle();
    EXPECT_LT(report.bad_after, report.bad_before);
    EXPECT_GT(report.moved, 0u);
    std::vector<bool> in_cap(before.size(), false);
    for (std::size_t q = cap; q < scene.quads.size(); ++q) {
        for (const std::uint32_t v : scene.quads[q]) in_cap[v] = true;
    }
    for (std::size_t v = 0; v < before.size(); ++v) {
        const Vec3 p = scene.positions[v];
        EXPECT_LE(p.z, kPlane + 1e-5f);
        EXPECT_TRUE(!in_cap[v] || on_plane(p)) << p.z;
        EXPECT_LE(radius(p), 1.001f);
    }
    for (std::size_t q = 0; q < cap; ++q) {
        for (const std::uint32_t v : scene.quads[q]) {
            EXPECT_TRUE(!in_cap[v] || radius(scene.positions[v]) > 0.999f) << "the rim stays on the surface";
        }
    }
}

TEST(Untangle, PreservesBoundaries) {
    Scene scene = tube();
    const Buffer<Vec3> clean = scene.positions;
    for (std::size_t q = 0; q < 16 * 12; q += 48) scene.fold(q + 4);  // one row above the open end
    scene.untangle();
    for (std::size_t v = 0; v < clean.size(); ++v) {
        if (clean[v].z > 1e-3f && clean[v].z < 6.599f) continue;
        EXPECT_EQ(scene.positions[v], clean[v]);
    }
    EXPECT_EQ(scene.count_bad(), 0u);
}

TEST(Untangle, WithoutProjectedPassesDoesNotSampleTheField) {
    Scene scene = tube();
    std::atomic<int> query_count{0};
    scene.field = {[&](std::uint32_t, Vec3 p) {
        ++query_count;
        return compact({p.x, p.y, 0});
    }};
    scene.fold(1000);
    EXPECT_EQ(scene.untangle({.projected_passes = 0}).bad_after, 0u);
    EXPECT_EQ(query_count, 0);
}

TEST(Untangle, SmoothingSufficesIfTheFieldIsZero) {
    Scene scene = tube();
    scene.field = {[](std::uint32_t, Vec3) { return FieldSample{0, {}}; }};
    scene.fold(1000);
    const UntangleReport report = scene.untangle();
    EXPECT_GT(report.bad_before, 0u);
    EXPECT_EQ(report.bad_after, 0u);
    for (const Vec3& p : scene.positions) EXPECT_NEAR(std::hypot(p.x, p.y), 1, 0.1f);
}

TEST(Untangle, IsFiniteForAnyField) {
    for (std::size_t k = 0; k <= kNastySamples.size(); ++k) {
        SCOPED_TRACE(k);
        Scene scene = ball();
        for (std::size_t q = 0; q < scene.quads.size(); q += 11) scene.fold(q);
        scene.field = nasty_field(k);
        const UntangleReport report = scene.untangle({.passes = 50, .projected_passes = 50});
        EXPECT_LE(report.bad_after, report.bad_before);
        for (const Vec3& p : scene.positions) EXPECT_TRUE(is_finite(p) && length(p) < 10);
    }
}

TEST(Untangle, SamplesAVertexInTheRegionOfItsOwner) {
    Scene scene = tube();
    for (std::size_t f = 0; f < scene.regions.size(); ++f) {
        scene.regions[f] = static_cast<std::uint32_t>(f / 12);  // one per ring, 0.6 high
    }
    std::atomic<int> query_count{0}, strangers{0};
    scene.field = {[&](std::uint32_t region, Vec3 p) {
        ++query_count;
        const float low = 0.6f * static_cast<float>(region);
        if (p.z < low - 0.15f || p.z > low + 0.75f) ++strangers;
        return compact({p.x, p.y, 0});
    }};
    for (std::size_t q = 300; q < scene.quads.size() - 300; q += 97) scene.fold(q);
    EXPECT_EQ(scene.untangle().bad_after, 0u);
    EXPECT_GT(query_count, 0);
    EXPECT_EQ(strangers, 0);
}

TEST(Untangle, IsBitIdenticalForAnyNumberOfThreads) {
    const auto run = [](unsigned threads) {
        Scene scene(tube_cage(60, 60, 1, 0.1f, false), on_axis, cylinder_field());
        scene.project();
        for (std::size_t q = 3; q < scene.quads.size(); q += 131) scene.fold(q);
        const UntangleReport report = scene.untangle({}, threads);
        return std::pair{scene.positions, report};
    };
    const auto one = run(1);
    EXPECT_GT(one.second.moved, 5000u);
    for (const unsigned threads : {2u, 7u}) {
        const auto many = run(threads);
        EXPECT_EQ(differences(one.first, many.first), 0u);
        EXPECT_EQ(one.second, many.second);
    }
}

TEST(Untangle, RejectsInvalidSizesAndOptions) {
    Scene scene = ball();
    EXPECT_THROW(scene.untangle({.passes = -1}), InvalidInput);
    EXPECT_THROW(scene.untangle({.quality = 1}), InvalidInput);
    Scene quads = scene, regions = scene, clips = scene, anchors = scene;
    quads.quads.pop_back();
    EXPECT_THROW(quads.untangle(), InvalidInput);
    regions.regions.pop_back();
    EXPECT_THROW(regions.untangle(), InvalidInput);
    clips.clips.resize(1);
    EXPECT_THROW(clips.untangle(), InvalidInput);
    anchors.anchors.pop_back();
    EXPECT_THROW(anchors.untangle(), InvalidInput);
}

TEST(UntangleOptions, EveryMemberIsDescribedWithADefaultInRange) {
    test::expect_described<UntangleOptions>();
}

}  // namespace
}  // namespace coppice
