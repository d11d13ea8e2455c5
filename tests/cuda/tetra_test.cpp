#include <gtest/gtest.h>

#include <algorithm>
#include <limits>
#include <optional>
#include <vector>

#include "coppice/cuda/exec/host_executor_internal.h"
#include "coppice/cuda/tetra/cut_convolution.h"
#include "coppice/cuda/tetra/device_marcher.h"
#include "coppice/cuda/tetra/march_stages_internal.h"
#include "coppice/tetra/march/snapping_internal.h"
#include "cuda/march_support.h"
#include "cuda/tetra_scene.h"
#include "cuda/workloads.h"
#include "tetra/support.h"

// Tests of the marching kernels for devices, run on the CPU and compared with march().

namespace coppice {
namespace {

using cuda::HostExecutor;

template <class F>
MarchResult march_by_kernels(const TetraMesh& mesh, const F& field, const InsideAxes& axes,
                             const MarchOptions& options, unsigned threads = 2) {
    const Context ctx{.threads = threads};
    HostExecutor exec(ctx);
    const cuda::DeviceRefinement refinement = cuda::refine(exec, mesh, options.levels);
    return cuda::downloaded(exec,
                            cuda::march(exec, refinement, cuda::upload_axes(exec, axes, refinement),
                                        cuda::SnapField<PointField<F>>{
                                            {&field}, tetra_kernel::Profile(field.level()), options.snap},
                                        options.refinements, ctx));
}

TEST(MarchKernels, AreBitIdenticalToMarchOnNoise) {
    std::uint64_t freed = 0, triangles = 0;
    for (std::uint64_t seed = 0; seed < 3; ++seed) {
        TetraMesh mesh = bcc_block({5, 5, 5}, 1, {0, 0, 0});
        if (seed > 0) mesh = shuffled(bent(mesh, 0.12f, seed), seed);
        mesh.positions.push_back({2, 2, 2});  // without a tetrahedron
        for (int levels = 0; levels <= (seed == 0 ? 3 : 2); ++levels) {
            for (const float snap : {0.0f, 0.45f}) {
                SCOPED_TRACE(testing::Message() << seed << " levels " << levels << " snap " << snap);
                const AnyField field = noise(seed, 1.7f * static_cast<float>(1 << levels), {5, 5, 5});
                const MarchOptions options{.levels = levels, .snap = snap};
                const CompressedRows<std::uint32_t> none;
                const MarchResult expected = march(mesh, FieldRef(field), options);
                expect_same(march_by_kernels(mesh, field, InsideAxes{{}, none}, options), expected);
                freed += expected.report.freed;
                triangles += expected.mesh.triangles.size();
            }
        }
    }
    EXPECT_GT(freed, 0u);
    EXPECT_GT(triangles, 1000u);
}

TEST(MarchKernels, AcceptNonFiniteFieldValues) {
    const TetraMesh mesh = bcc_block({5, 5, 5}, 1, {0, 0, 0});
    const AnyField field{[](Vec3 p) {
        if (p.x < 2) return std::numeric_limits<float>::quiet_NaN();
        return p.y < 2 ? std::numeric_limits<float>::infinity() : 1.2f - distance(p, {2.5f, 2.5f, 2.5f});
    }};
    const CompressedRows<std::uint32_t> none;
    for (const int refinements : {0, 1, 5}) {
        const MarchOptions options{.levels = 2, .refinements = refinements};
        const MarchResult expected = march(mesh, FieldRef(field), options);
        expect_same(march_by_kernels(mesh, field, InsideAxes{{}, none}, options), expected);
    }
}

TEST(MarchKernels, ReportOpenFaces) {
    const TetraMesh mesh = bcc_block({4, 4, 4}, 1, {0, 0, 0});
    const KernelField field = ball_field({0.9f, 2, 2}, 0.8f);
    const CompressedRows<std::uint32_t> none;
    const MarchResult expected = march(mesh, FieldRef(field));
    ASSERT_FALSE(expected.open.empty());
    expect_same(march_by_kernels(mesh, field, InsideAxes{{}, none}, {}), expected);
}

TEST(MarchKernels, AreBitIdenticalToMarchOfTrees) {
    for (const auto& [name, skeleton] : small_trees()) {
        for (int levels = 0; levels <= 2; ++levels) {
            SCOPED_TRACE(testing::Message() << name << " levels " << levels);
            const TetraScene scene(skeleton, levels, 0.7f);
            const MarchOptions options{.levels = levels, .snap = levels == 2 ? 0 : 0.45f};
            const MarchResult expected =
                march(scene.lattice.mesh(), FieldRef(scene.field), scene.inside(), options);
            expect_same(march_by_kernels(scene.lattice.mesh(), scene.field, scene.inside(), options),
                        expected);
        }
    }
}

// With a twentieth of its weight the field is below its iso value everywhere: axes are held by corners that
// move.
TEST(MarchKernels, PreserveAxesOutsideOfTheIsoSurface) {
    for (const float factor : {0.05f, 0.9f}) {
        TetraScene scene(random_tree(60, 4, true), 1, 0.9f, {}, 0);
        scene.field.scale_weights(std::vector<float>(scene.skeleton.size(), factor));
        const MarchOptions options{.levels = 1};
        const MarchResult expected =
            march(scene.lattice.mesh(), FieldRef(scene.field), scene.inside(), options);
        ASSERT_FALSE(expected.mesh.triangles.empty());
        expect_same(march_by_kernels(scene.lattice.mesh(), scene.field, scene.inside(), options), expected);
    }
}

/// Counts of results.
struct Snapping {
    std::ptrdiff_t folds = 0, single = 0, unknown = 0;
};

/// Compares the intermediate results, since unsnap() recomputes unknown fans and would hide fans that are not
/// recognised.
template <class F>
void expect_same_snapping(const TetraMesh& mesh, int levels, const F& field, Snapping& found) {
    const Context one{.threads = 1};  // fans are listed in the same order
    const TetraRefinement refinement(mesh, levels, one);
    const tetra_internal::HeldVertices none{tetra_internal::RankedBits(refinement.vertex_count()), {}, {}};
    auto samples = tetra_internal::sample_vertices(refinement, FieldRef(field), 0.45f, none, {}, one);
    HostExecutor exec(one);
    const cuda::DeviceRefinement refined = cuda::refine(exec, mesh, levels);
    const cuda::DeviceHeld held = cuda::hold_axes(exec, {}, refined);
    const cuda::SnapField<PointField<F>> at{{&field}, tetra_kernel::Profile(field.level()), 0.45f};
    const cuda::DeviceSamples sampled = cuda::sample_vertices(exec, refined, at, held);
    const auto marks = cuda::no_bits(exec, refined.vertex_count);
    exec.each("folds", refined.tetra_count, cuda::FindFold{refined, sampled.view, marks});
    const auto folds = cuda::list_bits(exec, marks);
    EXPECT_TRUE(std::ranges::equal(folds, tetra_internal::find_folds(refinement, samples, one)));
    found.folds += std::ssize(folds);
    for (const std::uint32_t v : folds) samples.put_back(v);
    cuda::put_back(exec, folds, sampled);
    const tetra_internal::CrossedTetra crossed(refinement, samples, one);
    const auto fans =
        cuda::begin_fans(exec, {refined, sampled.view, tetra_kernel::kCuts}, sampled.placed_count).fans;
    EXPECT_TRUE(std::ranges::equal(fans, tetra_internal::find_fans(refinement, samples, crossed, one)));
    found.single += std::ranges::count(fans, tetra_kernel::Fan::single);
    found.unknown += std::ranges::count(fans, tetra_kernel::Fan::unknown);
}

TEST(MarchKernels, ReportTheSameFoldsAndFans) {
    Snapping found;
    for (int levels = 0; levels <= 2; ++levels) {
        SCOPED_TRACE(levels);
        const TetraMesh mesh = shuffled(bent(bcc_block({5, 5, 5}, 1, {0, 0, 0}), 0.12f, 1), 1);
        expect_same_snapping(mesh, levels, noise(1, 1.7f * static_cast<float>(1 << levels), {5, 5, 5}),
                             found);
        const TetraScene scene(random_tree(60, 4, true), levels, 0.6f);
        expect_same_snapping(scene.lattice.mesh(), levels, scene.field, found);
    }
    EXPECT_GT(found.folds, 100);
    EXPECT_GT(found.single, 1000);
    EXPECT_GT(found.unknown, 10);
}

TEST(MarchKernels, AreBitIdenticalForAnyNumberOfThreads) {
    const TetraScene scene(random_tree(60, 4, true), 1, 0.5f);
    const MarchOptions options{.levels = 1};
    const MarchResult one = march_by_kernels(scene.lattice.mesh(), scene.field, scene.inside(), options, 1);
    for (const unsigned threads : {2u, 7u})
        expect_same(march_by_kernels(scene.lattice.mesh(), scene.field, scene.inside(), options, threads),
                    one);
}

/// Executes march() with the field and its regions in the layout of a GPU.
MarchResult march_as_a_card(const TetraMesh& mesh, const CutConvolution& field, const InsideAxes& axes,
                            const MarchOptions& options) {
    HostExecutor exec;
    const cuda::MarchJob job = cuda::upload_march(exec, {mesh, field, axes, options});
    return cuda::downloaded(exec, cuda::march(exec, job).value());
}

TEST(MarchKernels, MatchMarchWithTheFieldOfACard) {
    std::size_t same = 0, all = 0, turn = 0;
    for (const auto& [name, skeleton] : small_trees()) {
        for (const Kernel kernel : {Kernel::quartic, Kernel::cauchy, Kernel::scalis, Kernel::balls}) {
            if (kernel != Kernel::quartic && ++turn % 4 != 0) continue;
            SCOPED_TRACE(testing::Message() << name << " kernel " << static_cast<int>(kernel));
            const TetraScene scene(skeleton, 1, 0.6f, {.kernel = kernel});
            const EndCuts ends = cut_at_root(skeleton, scene.lattice.mesh().region_count());
            const CutConvolution field{scene.field, ends};
            const MarchOptions options{.levels = 1};
            const MarchResult expected =
                march(scene.lattice.mesh(), FieldRef(field), scene.inside(), options);
            const MarchResult found = march_as_a_card(scene.lattice.mesh(), field, scene.inside(), options);
            expect_alike(scene, found, expected, 7);
            ++all;
            same += found.mesh.triangles == expected.mesh.triangles ? 1 : 0;
        }
    }
    EXPECT_GT(same, all / 2) << "positions were hardly compared";
}

TEST(MarchKernels, MatchMarchOnTheWorkloads) {
    for (const char* name : {"tree300.swc", "tree300hard.swc", "tree3k.swc"}) {
        const std::optional<Skeleton> tree = workload(name);
        if (!tree) GTEST_SKIP() << "no workloads next to the checkout";
        SCOPED_TRACE(name);
        const TetraScene scene(*tree, 1, 0.8f);
        const EndCuts none;
        const CutConvolution field{scene.field, none};
        const MarchOptions options{.levels = 1};
        const MarchResult expected = march(scene.lattice.mesh(), FieldRef(field), scene.inside(), options);
        expect_same(march_by_kernels(scene.lattice.mesh(), scene.field, scene.inside(), options), expected);
        expect_alike(scene, march_as_a_card(scene.lattice.mesh(), field, scene.inside(), options), expected,
                     997);
    }
}

TEST(CutConvolution, EndsInAPlane) {
    const Skeleton tree = random_tree(20, 2);
    TetraScene scene(tree, 1, 0.6f, {.root_extension = 1.5f});
    const EndCuts ends = cut_at_root(tree, scene.lattice.mesh().region_count());
    ASSERT_EQ(ends.cuts.size(), 1u);
    const CutConvolution field{scene.field, ends};
    const MarchResult r = march(scene.lattice.mesh(), FieldRef(field), {.levels = 1});
    float lowest = 0;
    for (const Vec3 p : r.mesh.positions) lowest = std::min(lowest, p.z);
    const float radius = tree.radius(NodeId(0));
    EXPECT_LT(lowest, 0.1f * radius);
    EXPECT_GT(lowest, -0.15f * radius) << "the field extends by 1.5 radii";
}

TEST(DeviceMarcher, ThrowsWithoutADevice) {
    if (find_device().device) GTEST_SKIP() << "there is a device";
    EXPECT_THROW(DeviceMarcher(), DeviceError);
}

}  // namespace
}  // namespace coppice
