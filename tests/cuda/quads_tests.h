#pragma once

#include <gtest/gtest.h>

#include "coppice/cuda/quads/project_field_internal.h"
#include "on_executor.h"
#include "quads_case.h"

// Tests of the stages of quads on any executor, compared with the CPU.

namespace coppice::cuda {

template <class Exec>
Surface by_kernels(const QuadCase& c, const ProjectOptions& how, const UntangleOptions& unfolding,
                   unsigned threads = 2) {
    Exec exec(Context{.threads = threads});
    QuadStages<Exec> stages(exec, c.job(how, unfolding));
    const FieldArrays arrays = upload_field(exec, c.field);
    Surface out;
    stages.refine();
    project(stages, c.field.kernel(), arrays);
    out.projected = stages.projected();
    out.untangled = untangle(stages, c.field.kernel(), arrays);
    out.positions = downloaded(exec, stages.positions());
    out.anchors = downloaded(exec, stages.anchors());
    return out;
}

/// Unfolds the projection of the CPU.
template <class Exec>
UntangleReport unfolded_by_kernels(const QuadCase& c, const Surface& projected, Buffer<Vec3>& out) {
    Exec exec(Context{.threads = 2});
    QuadStages<Exec> stages(exec, c.job());
    const FieldArrays arrays = upload_field(exec, c.field);
    const std::size_t count = projected.positions.size();
    const PointPair points{exec.template array<Vec3>(count), exec.template array<Vec3>(count)};
    exec.write(std::span<const Vec3>(projected.positions), points.positions);
    exec.write(std::span<const Vec3>(projected.anchors), points.anchors);
    stages.put_points(points);
    const UntangleReport report = untangle(stages, c.field.kernel(), arrays);
    out = downloaded(exec, stages.positions());
    return report;
}

template <class Exec>
class QuadStagesOn : public OnExecutor<Exec> {};
TYPED_TEST_SUITE_P(QuadStagesOn);

TYPED_TEST_P(QuadStagesOn, ProjectAsTheCpu) {
    std::size_t apart = 0, all = 0;
    for (const auto& [name, skeleton] : skeleton_zoo()) {
        for (const int levels : {0, 1, 2}) {
            SCOPED_TRACE(name + ", level " + std::to_string(levels));
            const QuadCase c(skeleton, levels);
            const Surface cpu = on_cpu(c, {}, kNoUnfolding);
            const Surface kernels = by_kernels<TypeParam>(c, {}, kNoUnfolding);
            // Collinear children have whole sides in planes of symmetry.
            expect_same(cpu, kernels, TestFixture::kSameBits ? 0.1 : 0.3,
                        TestFixture::kSameBits ? 0.02 : 0.2);
            apart += differing(cpu, kernels);
            all += cpu.positions.size();
        }
    }
    EXPECT_LT(apart, all / 500);
}

TYPED_TEST_P(QuadStagesOn, UnfoldAsTheCpu) {
    std::uint64_t bad = 0, left = 0, left_by_kernels = 0;
    for (const auto& [name, skeleton] : skeleton_zoo()) {
        for (const int levels : {1, 2}) {
            SCOPED_TRACE(name + ", level " + std::to_string(levels));
            const QuadCase c(skeleton, levels);
            Surface cpu = on_cpu(c, {}, kNoUnfolding), kernels = cpu;
            kernels.untangled = unfolded_by_kernels<TypeParam>(c, cpu, kernels.positions);
            const ProjectionTarget target{FieldRef(c.field), c.control.region, c.control.clip};
            const Buffer<Quad> quads = c.patches.quads();
            cpu.untangled = coppice::untangle({cpu.positions, cpu.anchors, quads}, c.patches, target, {});
            bad += cpu.untangled.bad_before;
            left += cpu.untangled.bad_after;
            left_by_kernels += kernels.untangled.bad_after;
            EXPECT_TRUE(near(cpu.untangled.bad_before, kernels.untangled.bad_before, 0.001));
            // If passes do not unfold a face, rounding accumulates.
            if (!TestFixture::kSameBits) continue;
            EXPECT_EQ(cpu.untangled.bad_before, kernels.untangled.bad_before);
            EXPECT_EQ(cpu.untangled.passes, kernels.untangled.passes);
            EXPECT_TRUE(near(cpu.untangled.bad_after, kernels.untangled.bad_after, 0.02));
            EXPECT_TRUE(cpu.untangled.bad_after > 0 || differing(cpu, kernels) == 0);
        }
    }
    EXPECT_GT(bad, 1000u);
    EXPECT_TRUE(near(left, left_by_kernels, 0.05)) << left << " " << left_by_kernels;
}

TYPED_TEST_P(QuadStagesOn, RefineToTheQuadsOfTheCpu) {
    const QuadCase c(zoo_skeleton("random_1"), 4);
    const ProjectOptions none{.method = ProjectionMethod::none};
    const Surface cpu = on_cpu(c, none, {}), kernels = by_kernels<TypeParam>(c, none, {});
    ASSERT_EQ(cpu.positions.size(), kernels.positions.size());
    if (TestFixture::kSameBits) {
        EXPECT_EQ(cpu.positions, kernels.positions);
        EXPECT_EQ(cpu.anchors, kernels.anchors);
    }
    for (std::size_t v = 0; v < cpu.positions.size(); ++v) {
        ASSERT_LT(distance(cpu.positions[v], kernels.positions[v]), 1e-6f * length(cpu.positions[v]) + 1e-7f);
        ASSERT_LT(distance(cpu.anchors[v], kernels.anchors[v]), 1e-6f * length(cpu.anchors[v]) + 1e-7f);
    }
    TypeParam exec;
    QuadStages<TypeParam> stages(exec, c.job());
    stages.make_quads();
    EXPECT_EQ(downloaded(exec, stages.quads()), c.patches.quads());
}

TYPED_TEST_P(QuadStagesOn, ProjectWithEveryKernelAndMethodAsTheCpu) {
    for (const auto& [kernel, blend] : {std::pair{Kernel::quartic, 1},
                                        {Kernel::quartic, 2},
                                        {Kernel::quartic, 8},
                                        {Kernel::cauchy, 4},
                                        {Kernel::scalis, 4},
                                        {Kernel::balls, 1}}) {
        const QuadCase c(zoo_skeleton("random_1"), 2, {.kernel = kernel, .blend = blend});
        for (const ProjectionMethod method :
             {ProjectionMethod::rays, ProjectionMethod::gradient, ProjectionMethod::newton}) {
            SCOPED_TRACE(static_cast<int>(kernel) * 10 + static_cast<int>(method));
            const ProjectOptions how{.method = method, .relax_passes = 1};
            expect_same(on_cpu(c, how, kNoUnfolding), by_kernels<TypeParam>(c, how, kNoUnfolding), 0.01);
        }
    }
}

TYPED_TEST_P(QuadStagesOn, CutFlatEnds) {
    ControlOptions flat;
    flat.tips = TipShape::flat;
    const QuadCase c(zoo_skeleton("random_1"), 2, {.tip_extension = 1.5f}, flat);
    ASSERT_FALSE(c.control.clip.empty());
    const Surface cpu = on_cpu(c, {}, {}), kernels = by_kernels<TypeParam>(c, {}, {});
    EXPECT_GT(kernels.projected.clipped, 0u);
    expect_same(cpu, kernels, 0);
}

TYPED_TEST_P(QuadStagesOn, AreIdenticalInASecondRun) {
    const QuadCase c(zoo_skeleton("random_1"), 2);
    const Surface once = by_kernels<TypeParam>(c, {}, {}, 1);
    EXPECT_EQ(once.positions, by_kernels<TypeParam>(c, {}, {}, 4).positions);
}

TYPED_TEST_P(QuadStagesOn, NormalsPointOutward) {
    const QuadCase c(zoo_skeleton("random_1"), 2);
    TypeParam exec;
    QuadStages<TypeParam> stages(exec, c.job());
    stages.refine();
    stages.make_normals();
    const Buffer<Vec3> normals = downloaded(exec, stages.normals());
    const Buffer<Vec3> positions = downloaded(exec, stages.positions());
    const Buffer<Vec3> anchors = downloaded(exec, stages.anchors());
    std::size_t outward = 0;
    for (std::size_t v = 0; v < normals.size(); ++v) {
        EXPECT_NEAR(length(normals[v]), 1.0f, 1e-5f);
        outward += dot(normals[v], positions[v] - anchors[v]) > 0;
    }
    EXPECT_GT(outward, normals.size() * 99 / 100);
}

REGISTER_TYPED_TEST_SUITE_P(QuadStagesOn, ProjectAsTheCpu, UnfoldAsTheCpu, RefineToTheQuadsOfTheCpu,
                            ProjectWithEveryKernelAndMethodAsTheCpu, CutFlatEnds, AreIdenticalInASecondRun,
                            NormalsPointOutward);

}  // namespace coppice::cuda
