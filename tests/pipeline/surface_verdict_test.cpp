#include "coppice/pipeline/surface_verdict.h"
#include "coppice/measure/surface_report.h"
#include "coppice/pipeline/mesh_skeleton.h"

#include <gtest/gtest.h>

#include <vector>

namespace coppice {
namespace {

constexpr NodeId kRoot = NodeId::none();

/// A stem with a lateral.
Skeleton fork() {
    return Skeleton({kRoot, NodeId(0), NodeId(1), NodeId(1)}, {{0, 0, 0}, {0, 0, 3}, {0, 0, 6}, {2, 0, 4}},
                    {0.3f, 0.3f, 0.2f, 0.15f});
}

/// The same, and a lateral that leaves the leader.
Skeleton with_another() {
    return Skeleton({kRoot, NodeId(0), NodeId(1), NodeId(1), NodeId(2), NodeId(2)},
                    {{0, 0, 0}, {0, 0, 3}, {0, 0, 6}, {2, 0, 4}, {0, 0, 9}, {-2, 0, 7}},
                    {0.3f, 0.3f, 0.2f, 0.15f, 0.2f, 0.15f});
}

TEST(JudgeSurface, AcceptsAnExactSurface) {
    for (const MeshMethod method : {MeshMethod::quads, MeshMethod::tetrahedra, MeshMethod::ramifications}) {
        const auto verdict = judge_surface(mesh_skeleton(fork(), {.method = method}), fork(), {});
        ASSERT_TRUE(verdict);
        ASSERT_TRUE(verdict->volume);
        // Triangles have their corners on the surface, and so enclose less.
        const bool has_true_sections = method != MeshMethod::tetrahedra;
        EXPECT_NEAR(verdict->volume->ratio(), 1, has_true_sections ? 0.015 : 0.07);
        EXPECT_EQ(verdict->is_good(), has_true_sections);
        EXPECT_TRUE(verdict->axes.is_perfect());
        EXPECT_LT(verdict->volume->error, 0.01 * verdict->volume->cones);
        EXPECT_EQ(verdict->axes.tips, 2u);
    }
}

TEST(JudgeSurface, ReportsMissingBranches) {
    const auto verdict = judge_surface(mesh_skeleton(fork()), with_another(), {});
    EXPECT_FALSE(verdict->is_good());
    EXPECT_FALSE(verdict->holds_volume());
    EXPECT_EQ(verdict->axes.severed, 2u);  // both that leave node 2
    EXPECT_EQ(verdict->axes.missing, 2u);
    EXPECT_EQ(verdict->axes.short_tips, 2u);
}

TEST(JudgeSurface, UsesTheFittedVolume) {
    const MeshResult fitted = mesh_skeleton(fork(), {.fit = Fit::volume});
    const auto verdict = judge_surface(fitted, fork(), {});
    EXPECT_EQ(verdict->volume->mesh, fitted.fitted->after);
    EXPECT_TRUE(verdict->is_good());
}

TEST(JudgeSurface, CountsCrossingsOfSurfacesThatAreNotRemeshed) {
    const Skeleton bars({kRoot, NodeId(0), kRoot, NodeId(2)},
                        {{-3, 0, 0}, {3, 0, 0}, {0, -3, 0.1f}, {0, 3, 0.1f}}, {0.5f, 0.5f, 0.4f, 0.4f});
    const MeshResult kept = mesh_skeleton(bars, {.overlaps = Overlaps::keep});
    EXPECT_EQ(kept.quads().repair.pairs_after, 0u);
    const std::uint64_t crossings = judge_surface(kept, bars, {})->crossings;
    EXPECT_EQ(crossings, check_surface(to_polygons(kept.quads().mesh), nullptr).intersections->total);
    EXPECT_GT(crossings, 0u);
    EXPECT_EQ(judge_surface(mesh_skeleton(bars), bars, {})->crossings, 0u);
}

TEST(JudgeSurface, OmitsTheVolumeOfAnOpenSurface) {
    MeshOptions options;
    options.control.base = BaseShape::open;
    const auto verdict = judge_surface(mesh_skeleton(fork(), options), fork(), options.control);
    EXPECT_FALSE(verdict->volume);
    EXPECT_TRUE(verdict->is_good());
}

TEST(JudgeSurface, ReturnsNothingForCylinders) {
    EXPECT_FALSE(judge_surface(mesh_skeleton(fork(), {.method = MeshMethod::cylinders}), fork(), {}));
}

TEST(JudgeSurface, IsBitIdenticalForAnyNumberOfThreads) {
    const MeshResult made = mesh_skeleton(with_another());
    const auto one = judge_surface(made, with_another(), {}, {.threads = 1});
    const auto many = judge_surface(made, with_another(), {}, {.threads = 7});
    EXPECT_EQ(*one->volume, *many->volume);
    EXPECT_EQ(one->axes, many->axes);
}

}  // namespace
}  // namespace coppice
