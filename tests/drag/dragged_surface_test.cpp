#include "drag/dragged_surface.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "coppice/base/rotation.h"
#include "coppice/pipeline/mesh_skeleton.h"
#include "coppice/pipeline/quads/quad_build.h"
#include "coppice/skeleton/random_tree.h"
#include "drag/branch_drag.h"
#include "drag/drag_part.h"
#include "drag_scenes.h"
#include "errors.h"
#include "zoo.h"

namespace coppice::bench {
namespace {

using test::Dragged;
using test::kMax;

Skeleton small_tree() { return random_tree(400, 3); }

/// In the order of the build's refined quads.
Buffer<Vec3> in_model_order(const DragPart& part, std::span<const Vec3> drawn) {
    Buffer<Vec3> out(drawn.size());
    for (std::size_t i = 0; i < drawn.size(); ++i) out[part.vertex[i]] = drawn[i];
    return out;
}

TEST(BranchOfAbout, ReturnsTheLateralOfTheNearestSize) {
    // A stem of 8 segments; at node 2 a lateral of 1, at node 4 one of 3.
    std::vector<NodeId> parent{NodeId{}};
    std::vector<Vec3> place{{0, 0, 0}};
    std::vector<float> radius{0.1f};
    const auto add = [&](std::uint32_t p, Vec3 at, float r) {
        parent.emplace_back(p);
        place.push_back(at);
        radius.push_back(r);
    };
    for (std::uint32_t i = 0; i < 8; ++i) add(i, {0, 0, 1.0f * static_cast<float>(i + 1)}, 0.1f);
    add(2, {1, 0, 2.5f}, 0.04f);
    add(4, {1, 0, 4.5f}, 0.05f);
    add(10, {2, 0, 5}, 0.05f);
    add(11, {3, 0, 6}, 0.05f);
    const Skeleton tree(parent, place, radius);
    EXPECT_EQ(branch_of_about(tree, 1), NodeId(9));
    EXPECT_EQ(branch_of_about(tree, 500), NodeId(10));
    // Without laterals, the axis from the point with this remaining length.
    const Skeleton stem({NodeId{}, NodeId(0), NodeId(1), NodeId(2)}, {{}, {0, 0, 1}, {0, 0, 2}, {0, 0, 3}},
                        {1, 1, 1, 1});
    EXPECT_EQ(branch_of_about(stem, 2), NodeId(2));
    EXPECT_FALSE(branch_of_about(Skeleton({NodeId{}}, {Vec3{}}, {1.0f}), 5));
}

TEST(BranchDrag, SegmentsRotateExactlyAndForksPartially) {
    const Dragged d(small_tree());
    const DragPose pose = d.at(kMax);
    const Rotation turn = rotation_about(d.drag.axis(), kMax);
    for (const std::uint32_t n : d.drag.nodes()) {
        const Vec3d arm = Vec3d(d.build.skeleton.position(NodeId(n))) - d.drag.pivot();
        EXPECT_LT(distance(Vec3d(pose.nodes[n]), d.drag.pivot() + turn(arm)), 1e-5);
    }
    std::size_t partly = 0;
    for (const float share : d.drag.shares()) {
        EXPECT_GT(share, 0);
        EXPECT_LE(share, 1);
        partly += share < 1 ? 1 : 0;
    }
    EXPECT_GT(partly, 0u);
    EXPECT_LT(partly, 20u);  // of one fork
    std::size_t moved = 0;
    for (std::size_t v = 0; v < pose.cage.size(); ++v)
        moved += pose.cage[v] != d.build.cage.cage.positions[v] ? 1 : 0;
    EXPECT_EQ(moved, d.drag.cage_vertices().size());
}

TEST(DraggedSurface, AngleZeroIsBitIdenticalToTheRestSurface) {
    for (const auto& [name, skeleton] : skeleton_zoo()) {
        SCOPED_TRACE(name);
        const QuadBuild build = build_quads(skeleton);
        const NodeId top = branch_of_about(build.skeleton, 5);
        if (!top) continue;
        const BranchDrag drag(build, top, {1, 0, 0});
        const DragPart part = drag_part(build, drag, kMax);
        DraggedSurface surface(build, part);
        const Buffer<Vec3> normals(surface.normals().begin(), surface.normals().end());
        DragPose pose = drag.rest();
        for (const double angle : {kMax, 0.0}) {
            drag.turn(angle, pose);
            surface.make(pose);
        }
        EXPECT_EQ(in_model_order(part, surface.positions()), build.refined);
        EXPECT_TRUE(std::ranges::equal(surface.normals(), normals));
    }
}

TEST(DraggedSurface, PartIsBitIdenticalToTheWhole) {
    MeshOptions flat, relaxed, kept;
    flat.control.tips = TipShape::flat;
    flat.levels = 1;
    relaxed.project.relax_passes = 1;
    kept.overlaps = Overlaps::keep;
    kept.levels = 0;
    for (const MeshOptions& options : {MeshOptions{}, flat, relaxed, kept}) {
        const Dragged d(small_tree(), options);
        const DragPart whole = whole_part(d.build);
        EXPECT_EQ(whole.written, whole.vertex.size());
        if (options.project.relax_passes == 0) {
            EXPECT_LT(d.part.written, whole.written / 2);
        }
        DraggedSurface part(d.build, d.part), all(d.build, whole);
        for (const double angle : {-kMax, 0.07, kMax}) {
            const DragPose pose = d.at(angle);
            part.make(pose);
            all.make(pose);
            EXPECT_EQ(in_model_order(d.part, part.positions()), in_model_order(whole, all.positions()));
            EXPECT_EQ(in_model_order(d.part, part.normals()), in_model_order(whole, all.normals()));
        }
    }
}

TEST(DraggedSurface, PartIsBitIdenticalToTheWholeForOverlappingBranches) {
    for (const std::uint32_t segments : {5u, 40u, 150u}) {
        const Dragged d(random_tree(600, 4, true), {}, segments);
        const DragPart whole = whole_part(d.build);
        DraggedSurface part(d.build, d.part), all(d.build, whole);
        for (const double angle : {-kMax, -0.11, 0.3}) {
            const DragPose pose = d.at(angle);
            part.make(pose);
            all.make(pose);
            EXPECT_EQ(in_model_order(d.part, part.positions()), in_model_order(whole, all.positions()));
        }
    }
}

TEST(DraggedSurface, IsBitIdenticalForAnyNumberOfThreads) {
    const Dragged d(small_tree());
    const DragPose pose = d.at(0.2);
    DraggedSurface one(d.build, d.part), seven(d.build, d.part);
    one.make(pose, {.threads = 1});
    seven.make(pose, {.threads = 7});
    EXPECT_TRUE(std::ranges::equal(one.positions(), seven.positions()));
    EXPECT_TRUE(std::ranges::equal(one.normals(), seven.normals()));
}

TEST(DraggedSurface, PreservesTheShapeFarFromTheFork) {
    const Dragged d(small_tree());
    DraggedSurface surface(d.build, d.part);
    const Buffer<Vec3> rest(surface.positions().begin(), surface.positions().end());
    const ProjectReport report = surface.make(d.at(kMax));
    EXPECT_LT(report.not_converged, report.vertices / 100);
    // The tip of the branch: its last node, one radius beyond.
    const std::uint32_t tip = d.drag.nodes().back();
    const Vec3 at = d.build.skeleton.position(NodeId(tip));
    const float r = d.build.skeleton.radius(NodeId(tip));
    const Rotation turn = rotation_about(d.drag.axis(), kMax);
    std::size_t looked_at = 0;
    for (std::size_t i = 0; i < rest.size(); ++i) {
        if (distance(rest[i], at) > 1.2f * r) continue;
        const Vec3d expected = d.drag.pivot() + turn(Vec3d(rest[i]) - d.drag.pivot());
        EXPECT_LT(distance(Vec3d(surface.positions()[i]), expected), 0.01 * static_cast<double>(r));
        ++looked_at;
    }
    EXPECT_GT(looked_at, 3u);
}

}  // namespace
}  // namespace coppice::bench
