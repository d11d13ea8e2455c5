#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>

#include "coppice/base/error.h"
#include "coppice/cage/cage.h"
#include "coppice/cuda/exec/host_executor_internal.h"
#include "coppice/cuda/field/upload_field_internal.h"
#include "coppice/field/convolution_field.h"
#include "coppice/subdivision/project.h"
#include "printed_quad_stages.h"
#include "subdivision/cages.h"
#include "subdivision/match.h"
#include "zoo.h"

// Tests of the quads published in [Zhu2015], with the device kernels run on the CPU.

namespace coppice::bench {
namespace {

using cuda::HostExecutor;
using Stages = PrintedQuadStages<HostExecutor>;

/// A cage with its patches, and the job of subdividing it. Every quad is its own region.
struct Job {
    Job(const Cage& cage, int levels)
        : points(cage.points), region(cage.quads.size()), patches(cage.quads, cage.vertex_count(), levels) {
        for (std::uint32_t f = 0; f < region.size(); ++f) region[f] = f;
    }
    operator cuda::QuadJob() const {
        cuda::QuadJob job;
        job.cage = patches.cage();
        job.levels = patches.levels();
        job.positions = points;
        job.region = region;
        return job;
    }

    std::vector<Vec3> points;
    std::vector<std::uint32_t> region;
    PatchRefinement patches;
};

/// Expects edges and fans equal to those of PatchRefinement, except for the order of edges.
void expect_connected(const CageView& mesh) {
    std::vector<std::uint32_t> seen(4 * std::size_t{mesh.face_count()});
    for (std::uint32_t e = 0; e < mesh.edge_count(); ++e) {
        const auto [forward, backward] = mesh.edge_half[e];
        ASSERT_EQ(mesh.side[forward], 2 * e);
        ASSERT_EQ(mesh.side[backward], 2 * e + 1);
        ASSERT_EQ(mesh.corner(forward), mesh.corner(next_half_edge<4>(backward)));
        ASSERT_EQ(mesh.corner(backward), mesh.corner(next_half_edge<4>(forward)));
        ASSERT_LT(mesh.corner(forward), mesh.corner(backward));
        ++seen[forward];
        ++seen[backward];
    }
    EXPECT_EQ(std::ranges::count(seen, 1u), std::ssize(seen)) << "a half-edge is of no edge, or of two";
    const CompressedRows<std::uint32_t> fans = group_by(all_corners(mesh.quads), mesh.vertex_count());
    for (std::uint32_t v = 0; v < mesh.vertex_count(); ++v)
        ASSERT_TRUE(std::ranges::equal(mesh.fan(v), fans[v])) << v;
}

float measure_size(const Cage& cage) {
    Box3 box;
    for (const Vec3& p : cage.points) box.extend(p);
    return box.diagonal();
}

TEST(PrintedQuadStages, SubdivideAsPatchRefinement) {
    int closed = 0;
    for (const auto& [name, cage] : cage_zoo()) {
        if (!PatchRefinement(cage.quads, cage.vertex_count(), 0).cage().closed()) continue;
        ++closed;
        for (int levels = 0; levels <= 4; ++levels) {
            SCOPED_TRACE(name + ", levels " + std::to_string(levels));
            const Job job(cage, levels);
            HostExecutor exec(Context{.threads = 2});
            Stages stages(exec, job);
            stages.refine();
            const Buffer<Vec3> expected = job.patches.refine(job.points);
            const auto found = stages.refined();
            ASSERT_EQ(found.size(), expected.size());
            const auto map = match_points(found, expected, 1e-5f * measure_size(cage));
            ASSERT_EQ(std::ranges::count(map, expected.size()), 0) << "a vertex has no counterpart";
            EXPECT_EQ(canonical_quads(stages.mesh().quads, map), canonical_quads(job.patches.quads()));
            expect_connected(stages.mesh());
        }
    }
    EXPECT_EQ(closed, 9);
}

TEST(PrintedQuadStages, RejectBoundaries) {
    HostExecutor exec;
    const Job job(grid_cage(4, 3, false), 1);
    EXPECT_THROW(Stages(exec, job), InvalidInput);
}

TEST(PrintedQuadStages, PreserveVerticesWithoutQuads) {
    Cage cage = hub_cage(3);
    cage.points.push_back({5, 6, 7});
    const Job job(cage, 2);
    HostExecutor exec;
    Stages stages(exec, job);
    stages.refine();
    EXPECT_EQ(stages.refined()[8], (Vec3{5, 6, 7}));
}

/// The value decreases by 1 for each metre from the origin, and is 1 at a distance of 1 + r / 10 in region r.
struct Balls {
    FieldSample sample(std::uint32_t region, Vec3 p) const {
        const float radius = 1 + 0.1f * static_cast<float>(region);
        return {1 + radius - length(p), p * (-1 / length(p))};
    }
};

// Each step leaves 1 - 0.95 of the distance: 1/400 after two steps.
TEST(PrintedQuadStages, MoveVerticesByEquationFive) {
    const Job job(shaken(hub_cage(3), 0.05f), 2);
    HostExecutor exec;
    Stages stages(exec, job);
    stages.refine();
    stages.evolve(Balls(), {.sigma = 0.95f, .steps = 2});
    const Buffer<Vec3> refined = job.patches.refine(job.points);
    const auto map = match_points(stages.refined(), refined, 1e-5f);
    const Buffer<std::uint32_t> owner = job.patches.owners();
    for (std::uint32_t v = 0; v < map.size(); ++v) {
        const Vec3 start = stages.refined()[v];
        const float radius = 1 + 0.1f * static_cast<float>(owner[map[v]]);
        const Vec3 expected = normalized(start) * (radius + (length(start) - radius) / 400);
        EXPECT_LT(distance(stages.positions()[v], expected), 2e-6f) << v;
    }
}

/// Zero gradient in region 0, and NaN in region 1.
struct Nothing {
    FieldSample sample(std::uint32_t region, Vec3) const {
        if (region == 0) return {0.5f, {}};
        return {std::numeric_limits<float>::quiet_NaN(), {1, 0, 0}};
    }
};

TEST(PrintedQuadStages, PreservePositionsIfTheGradientIsZero) {
    const Job job(hub_cage(4), 1);
    HostExecutor exec;
    Stages stages(exec, job);
    stages.refine();
    stages.evolve(Nothing());
    EXPECT_TRUE(std::ranges::equal(stages.positions(), stages.refined()));
}

/// Creates a cage with round ends, which have no boundaries and are not clipped.
ControlMesh cage_about(const Skeleton& skeleton) {
    ControlOptions options;
    options.base = BaseShape::round;
    options.tips = TipShape::round;
    std::vector<NodeId> all;
    for (const NodeId n : nodes(skeleton)) all.push_back(n);
    return build_control_mesh(skeleton, all, options, {});
}

// ProjectionMethod::newton executes the same steps, except that it stops vertices that are close enough or
// too far away.
TEST(PrintedQuadStages, MatchNewtonProjectionOnTrees) {
    std::size_t near = 0, all = 0;
    for (const auto& [name, skeleton] : skeleton_zoo()) {
        if (skeleton.size() > 200) continue;
        SCOPED_TRACE(name);
        const ControlMesh control = cage_about(skeleton);
        Job job({{control.cage.positions.begin(), control.cage.positions.end()},
                 {control.cage.quads.begin(), control.cage.quads.end()}},
                2);
        job.region.assign(control.region.begin(), control.region.end());
        ConvolutionField field(skeleton, {});
        std::vector<Box3> boxes(control.region_node.size());
        for (std::size_t f = 0; f < control.region.size(); ++f) {
            for (const std::uint32_t v : control.cage.quads[f])
                boxes[control.region[f]].extend(control.cage.positions[v]);
        }
        field.set_regions(boxes);
        HostExecutor exec(Context{.threads = 2});
        const cuda::FieldArrays arrays = cuda::upload_field(exec, field);
        Stages stages(exec, job);
        stages.refine();
        cuda::with_formula(field.kernel(), [&](const auto& formula) {
            stages.evolve(cuda::FieldView(formula, arrays), {.steps = 12});
        });

        const Buffer<Vec3> refined = job.patches.refine(job.points);
        const Buffer<Vec3> anchors = job.patches.refine(control.anchors);
        Buffer<Vec3> projected = refined;
        project(projected, anchors, job.patches, {FieldRef(field), job.region, {}},
                {.method = ProjectionMethod::newton});
        for (std::uint32_t v = 0; v < refined.size(); ++v) {
            EXPECT_TRUE(std::isfinite(length_squared(stages.positions()[v]))) << v;
        }
        Box3 box;
        for (const Vec3 p : refined) box.extend(p);
        const auto map = match_points(stages.refined(), refined, 1e-5f * box.diagonal());
        for (std::uint32_t v = 0; v < map.size(); ++v) {
            if (map[v] == refined.size()) continue;
            const Vec3 p = projected[map[v]];
            near += distance(stages.positions()[v], p) < 1e-3f * distance(p, anchors[map[v]]);
            ++all;
        }
    }
    EXPECT_GT(all, 10'000u);
    EXPECT_GT(near, all * 9 / 10) << all;
}

TEST(PrintedQuadStages, AreBitIdenticalForAnyNumberOfThreads) {
    const Job job(shaken(grid_cage(60, 40, true), 0.01f), 2);
    std::vector<Vec3> one;
    for (const unsigned threads : {1u, 2u, 7u}) {
        HostExecutor exec(Context{.threads = threads});
        Stages stages(exec, job);
        stages.refine();
        stages.evolve(Balls());
        std::vector<Vec3> found(stages.positions().begin(), stages.positions().end());
        if (threads == 1) one = found;
        EXPECT_EQ(found, one);
    }
}

// Each repetition starts from the same cage.
TEST(PrintedQuadStages, RepeatedRefinementIsIdentical) {
    const Job job(shaken(branching_cage(), 0.01f), 3);
    HostExecutor exec;
    Stages stages(exec, job);
    stages.refine();
    const std::vector<Vec3> first(stages.refined().begin(), stages.refined().end());
    stages.refine();
    EXPECT_TRUE(std::ranges::equal(stages.refined(), first));
}

}  // namespace
}  // namespace coppice::bench
