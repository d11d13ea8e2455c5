#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "coppice/cage/cage.h"
#include "coppice/cuda/exec/host_executor.h"
#include "coppice/cuda/field/upload_field.h"
#include "coppice/cuda/quads/quad_stages.h"
#include "coppice/field/convolution_field.h"
#include "zoo.h"

namespace coppice::cuda {
namespace {

std::vector<NodeId> all_nodes(const Skeleton& skeleton) {
    std::vector<NodeId> out;
    for (const NodeId n : nodes(skeleton)) out.push_back(n);
    return out;
}

/// A skeleton with all that a surface is made of.
struct Case {
    Skeleton skeleton;
    ControlMesh control;
    ConvolutionField field;
    PatchRefinement patches;

    Case(Skeleton of, int levels, const FieldOptions& options = {}, const ControlOptions& cage = {})
        : skeleton(std::move(of)),
          control(build_control_mesh(skeleton, all_nodes(skeleton), cage, {})),
          field(skeleton, options),
          patches(control.cage.quads, static_cast<std::uint32_t>(control.cage.positions.size()), levels) {
        std::vector<FieldRegion> regions(control.region_node.size());
        for (std::size_t f = 0; f < control.region.size(); ++f) {
            for (const std::uint32_t v : control.cage.quads[f]) {
                regions[control.region[f]].box.extend(control.cage.positions[v]);
                regions[control.region[f]].box.extend(control.anchors[v]);
            }
        }
        for (std::size_t r = 0; r < regions.size(); ++r) regions[r].seed = control.region_node[r];
        const std::vector<NodeId> tube = all_nodes(skeleton);
        field.set_regions(regions, {skeleton, tube});
    }
    Case(const Case&) = delete;

    QuadJob job(const ProjectOptions& project = {}, const UntangleOptions& untangle = {}) const {
        return {patches.cage(),  patches.levels(), control.cage.positions,
                control.anchors, control.region,   control.clip,
                project,         untangle};
    }
};

struct Surface {
    Buffer<Vec3> positions, anchors;
    ProjectReport projected;
    UntangleReport untangled;
};

Surface on_cpu(const Case& c, const ProjectOptions& project, const UntangleOptions& untangle) {
    Surface out{c.patches.refine(c.control.cage.positions), c.patches.refine(c.control.anchors), {}, {}};
    const ProjectionTarget target{FieldRef(c.field), c.control.region, c.control.clip};
    out.projected = coppice::project(out.positions, out.anchors, c.patches, target, project);
    const Buffer<Quad> quads = c.patches.quads();
    if (project.method != ProjectionMethod::none && c.patches.levels() > 0)
        out.untangled = coppice::untangle({out.positions, out.anchors, quads}, c.patches, target, untangle);
    return out;
}

template <class T>
Buffer<T> download(HostExecutor& exec, std::span<const T> from) {
    Buffer<T> out(from.size());
    exec.download(from, std::span<T>(out));
    return out;
}

Surface by_kernels(const Case& c, const ProjectOptions& project, const UntangleOptions& untangle,
                   unsigned threads = 2) {
    HostExecutor exec(Context{.threads = threads});
    QuadStages<HostExecutor> stages(exec, c.job(project, untangle));
    const FieldArrays arrays = upload_field(exec, c.field);
    Surface out;
    stages.refine();
    with_formula(c.field.kernel(), [&](const auto& formula) {
        const FieldView field(formula, arrays);
        stages.project(field);
        out.projected = stages.projected();
        out.untangled = stages.untangle(field);
    });
    out.positions = download(exec, stages.positions());
    out.anchors = download(exec, stages.anchors());
    return out;
}

/// How many vertices lie apart by more than 1e-4 of their distance from the anchor.
std::size_t differing(const Surface& a, const Surface& b) {
    std::size_t count = 0;
    for (std::size_t v = 0; v < a.positions.size(); ++v) {
        const float away = distance(a.positions[v], b.positions[v]);
        const float radius = std::max(distance(a.positions[v], a.anchors[v]), length(a.positions[v]) * 1e-6f);
        count += !(away <= 1e-4f * radius);
    }
    return count;
}

bool near(std::uint64_t x, std::uint64_t y, double share) {
    const auto a = static_cast<double>(x), b = static_cast<double>(y);
    return std::abs(a - b) <= 2 + share * std::max(a, b);
}

/// A ray within a plane of symmetry goes by rounding, which is not the same everywhere, to one side or the
/// other: `share` of the vertices may.
void expect_same(const Surface& a, const Surface& b, double share) {
    ASSERT_EQ(a.positions.size(), b.positions.size());
    EXPECT_LE(static_cast<double>(differing(a, b)), 3 + share * static_cast<double>(a.positions.size()));
    EXPECT_EQ(a.projected.vertices, b.projected.vertices);
    EXPECT_EQ(a.projected.clipped, b.projected.clipped);
    EXPECT_TRUE(near(a.projected.evaluations, b.projected.evaluations, 0.02))
        << a.projected.evaluations << " " << b.projected.evaluations;
    EXPECT_TRUE(near(a.projected.not_converged, b.projected.not_converged, 0.02))
        << a.projected.not_converged << " " << b.projected.not_converged;
}

constexpr UntangleOptions kNoUnfolding{.passes = 0};

TEST(QuadStages, ProjectAsTheCpu) {
    std::size_t apart = 0, all = 0;
    for (const auto& [name, skeleton] : skeleton_zoo()) {
        for (const int levels : {0, 1, 2}) {
            SCOPED_TRACE(name + ", level " + std::to_string(levels));
            const Case c(skeleton, levels);
            const Surface cpu = on_cpu(c, {}, kNoUnfolding), kernels = by_kernels(c, {}, kNoUnfolding);
            expect_same(cpu, kernels, 0.1);
            apart += differing(cpu, kernels);
            all += cpu.positions.size();
        }
    }
    EXPECT_LT(apart, all / 500);
}

/// Unfolds what the CPU has projected.
UntangleReport unfolded_by_kernels(const Case& c, const Surface& projected, Buffer<Vec3>& out) {
    HostExecutor exec(Context{.threads = 2});
    QuadStages<HostExecutor> stages(exec, c.job());
    const FieldArrays arrays = upload_field(exec, c.field);
    const PointPair points{exec.array<Vec3>(projected.positions.size()),
                           exec.array<Vec3>(projected.positions.size())};
    exec.write(std::span<const Vec3>(projected.positions), points.positions);
    exec.write(std::span<const Vec3>(projected.anchors), points.anchors);
    stages.put_points(points);
    UntangleReport report;
    with_formula(c.field.kernel(),
                 [&](const auto& formula) { report = stages.untangle(FieldView(formula, arrays)); });
    out = download(exec, stages.positions());
    return report;
}

TEST(QuadStages, UnfoldAsTheCpu) {
    std::uint64_t bad = 0;
    for (const auto& [name, skeleton] : skeleton_zoo()) {
        for (const int levels : {1, 2}) {
            SCOPED_TRACE(name + ", level " + std::to_string(levels));
            const Case c(skeleton, levels);
            Surface cpu = on_cpu(c, {}, kNoUnfolding), kernels = cpu;
            kernels.untangled = unfolded_by_kernels(c, cpu, kernels.positions);
            const ProjectionTarget target{FieldRef(c.field), c.control.region, c.control.clip};
            const Buffer<Quad> quads = c.patches.quads();
            cpu.untangled = coppice::untangle({cpu.positions, cpu.anchors, quads}, c.patches, target, {});
            EXPECT_EQ(cpu.untangled.bad_before, kernels.untangled.bad_before);
            EXPECT_EQ(cpu.untangled.passes, kernels.untangled.passes);
            EXPECT_TRUE(near(cpu.untangled.bad_after, kernels.untangled.bad_after, 0.02))
                << cpu.untangled.bad_after << " " << kernels.untangled.bad_after;
            // Where all passes do not unfold a face, rounding adds up.
            EXPECT_TRUE(cpu.untangled.bad_after > 0 || differing(cpu, kernels) == 0);
            bad += cpu.untangled.bad_before;
        }
    }
    EXPECT_GT(bad, 1000u);
}

TEST(QuadStages, RefineToTheBit) {
    const Case c(zoo_skeleton("random_1"), 4);
    const ProjectOptions none{.method = ProjectionMethod::none};
    const Surface cpu = on_cpu(c, none, {}), kernels = by_kernels(c, none, {});
    EXPECT_EQ(cpu.positions, kernels.positions);
    EXPECT_EQ(cpu.anchors, kernels.anchors);
    HostExecutor exec;
    QuadStages<HostExecutor> stages(exec, c.job());
    stages.make_quads();
    EXPECT_EQ(download(exec, stages.quads()), c.patches.quads());
}

TEST(QuadStages, KnowEveryKernelAndMethod) {
    for (const auto& [kernel, blend] : {std::pair{Kernel::quartic, 1},
                                        {Kernel::quartic, 2},
                                        {Kernel::quartic, 8},
                                        {Kernel::cauchy, 4},
                                        {Kernel::scalis, 4},
                                        {Kernel::balls, 1}}) {
        const Case c(zoo_skeleton("random_1"), 2, {.kernel = kernel, .blend = blend});
        for (const ProjectionMethod method :
             {ProjectionMethod::rays, ProjectionMethod::gradient, ProjectionMethod::newton}) {
            SCOPED_TRACE(static_cast<int>(kernel) * 10 + static_cast<int>(method));
            const ProjectOptions project{.method = method, .relax_passes = 1};
            expect_same(on_cpu(c, project, kNoUnfolding), by_kernels(c, project, kNoUnfolding), 0.01);
        }
    }
}

TEST(QuadStages, CutFlatEnds) {
    ControlOptions flat;
    flat.tips = TipShape::flat;
    const Case c(zoo_skeleton("random_1"), 2, {.tip_extension = 1.5f}, flat);
    ASSERT_FALSE(c.control.clip.empty());
    const Surface cpu = on_cpu(c, {}, {}), kernels = by_kernels(c, {}, {});
    EXPECT_GT(kernels.projected.clipped, 0u);
    expect_same(cpu, kernels, 0);
}

TEST(QuadStages, GiveTheSameBitsForAnyThreads) {
    const Case c(zoo_skeleton("random_1"), 2);
    EXPECT_EQ(by_kernels(c, {}, {}, 1).positions, by_kernels(c, {}, {}, 4).positions);
}

TEST(QuadStages, NormalsLookOutward) {
    const Case c(zoo_skeleton("random_1"), 2);
    HostExecutor exec;
    QuadStages<HostExecutor> stages(exec, c.job());
    stages.refine();
    stages.make_normals();
    const Buffer<Vec3> normals = download(exec, stages.normals());
    const Buffer<Vec3> positions = download(exec, stages.positions()),
                       anchors = download(exec, stages.anchors());
    std::size_t outward = 0;
    for (std::size_t v = 0; v < normals.size(); ++v) {
        EXPECT_NEAR(length(normals[v]), 1.0f, 1e-5f);
        outward += dot(normals[v], positions[v] - anchors[v]) > 0;
    }
    EXPECT_GT(outward, normals.size() * 99 / 100);
}

}  // namespace
}  // namespace coppice::cuda
