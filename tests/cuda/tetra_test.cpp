#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <optional>
#include <set>
#include <utility>
#include <vector>

#include "coppice/cuda/exec/host_executor.h"
#include "coppice/cuda/tetra/cut_convolution.h"
#include "coppice/cuda/tetra/device_marcher.h"
#include "coppice/cuda/tetra/march_stages.h"
#include "coppice/cuda/tetra/printed_stages.h"
#include "coppice/mesh/topology.h"
#include "coppice/tetra/march/snapping_internal.h"
#include "coppice/tetra/polyhedron/polyhedron.h"
#include "cuda/march_support.h"
#include "cuda/tetra_scene.h"
#include "cuda/workloads.h"
#include "tetra/support.h"
#include "tetra/surfaces.h"

// Tests of the marching kernels for devices, run on the CPU and compared with march().

namespace coppice {
namespace {

using cuda::ExplicitTetra;
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

TEST(MarchKernels, MakeTheSameBitsOnNoise) {
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

TEST(MarchKernels, TakeFieldsThatAreNoNumbers) {
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

TEST(MarchKernels, NameOpenFaces) {
    const TetraMesh mesh = bcc_block({4, 4, 4}, 1, {0, 0, 0});
    const KernelField field = ball_field({0.9f, 2, 2}, 0.8f);
    const CompressedRows<std::uint32_t> none;
    const MarchResult expected = march(mesh, FieldRef(field));
    ASSERT_FALSE(expected.open.empty());
    expect_same(march_by_kernels(mesh, field, InsideAxes{{}, none}, {}), expected);
}

TEST(MarchKernels, MakeTheSameBitsOfTrees) {
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
TEST(MarchKernels, HoldAxesThatTheFieldLoses) {
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

TEST(MarchKernels, FindTheSameFoldsAndFans) {
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

TEST(MarchKernels, GiveTheSameBitsForAnyNumberOfThreads) {
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

TEST(MarchKernels, AgreeWithTheFieldOfACard) {
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

TEST(MarchKernels, AgreeOnTheWorkloads) {
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

/// Returns the subdivision of the coarse mesh as published, without a field.
ExplicitTetra subdivided(HostExecutor& exec, const TetraMesh& mesh, int levels) {
    ExplicitTetra out = cuda::upload_explicit(exec, mesh);
    for (int l = 0; l < levels; ++l) out = cuda::subdivide(exec, out);
    return out;
}

TetraMesh as_mesh(const ExplicitTetra& from) {
    TetraMesh out;
    out.positions.assign(from.positions.begin(), from.positions.end());
    for (const auto& cell : from.tetra) out.tetra.push_back(cell.vertices);
    out.first.push_back(static_cast<std::uint32_t>(out.tetra.size()));
    return out;
}

/// Expects that edges and faces are exactly those of the tetrahedra, without duplicates.
void expect_connected(const ExplicitTetra& mesh) {
    std::vector<std::set<std::uint32_t>> of_edge(mesh.edges.size()), of_face(mesh.faces.size());
    for (std::size_t e = 0; e < mesh.edges.size(); ++e)
        of_edge[e] = {mesh.edges[e].vertices[0], mesh.edges[e].vertices[1]};
    std::vector<int> edge_used(mesh.edges.size()), face_used(mesh.faces.size());
    for (std::size_t f = 0; f < mesh.faces.size(); ++f) {
        const auto& face = mesh.faces[f];
        of_face[f] = {face.vertices[0], face.vertices[1], face.vertices[2]};
        ASSERT_EQ(of_face[f].size(), 3u);
        for (std::size_t k = 0; k < 3; ++k) {
            ASSERT_EQ(of_edge.at(face.edges[k]),
                      (std::set{face.vertices[(k + 1) % 3], face.vertices[(k + 2) % 3]}));
        }
    }
    for (const auto& cell : mesh.tetra) {
        for (std::size_t e = 0; e < 6; ++e) {
            ASSERT_EQ(of_edge.at(cell.edges[e]),
                      (std::set{cell.vertices[kTetraEdges[e][0]], cell.vertices[kTetraEdges[e][1]]}));
            edge_used[cell.edges[e]] = 1;
        }
        for (std::size_t f = 0; f < 4; ++f) {
            std::set<std::uint32_t> expected(cell.vertices.begin(), cell.vertices.end());
            expected.erase(cell.vertices[f]);
            ASSERT_EQ(of_face.at(cell.faces[f]), expected);
            ++face_used[cell.faces[f]];
        }
    }
    EXPECT_EQ(std::ranges::count(edge_used, 0), 0);
    EXPECT_EQ(std::ranges::count(face_used, 0), 0);
    EXPECT_LE(std::ranges::max(face_used), 2);
    EXPECT_EQ(std::set(of_edge.begin(), of_edge.end()).size(), of_edge.size());
    EXPECT_EQ(std::set(of_face.begin(), of_face.end()).size(), of_face.size());
}

TEST(PrintedMarch, SubdividesIntoEight) {
    for (const TetraMesh& mesh :
         {one_tetra(), shuffled(bent(bcc_block({3, 3, 2}, 1, {0, 0, 0}), 0.15f, 5), 6)}) {
        HostExecutor exec;
        for (int levels = 0; levels <= 3; ++levels) {
            SCOPED_TRACE(testing::Message() << mesh.tetra.size() << " levels " << levels);
            const ExplicitTetra fine = subdivided(exec, mesh, levels);
            expect_connected(fine);
            ASSERT_EQ(fine.tetra.size(), mesh.tetra.size() << 3 * levels);
            // Vertices, edges, faces and tetrahedra of a ball.
            EXPECT_EQ(static_cast<long>(fine.positions.size() + fine.faces.size()) -
                          static_cast<long>(fine.edges.size() + fine.tetra.size()),
                      1);
            // All have equal volumes, and the orientation of their coarse tetrahedron.
            for (std::size_t t = 0; t < fine.tetra.size(); ++t) {
                const Tetra& coarse = mesh.tetra[t >> 3 * levels];
                const double whole = volume6(mesh, coarse), part = std::ldexp(whole, -3 * levels);
                const auto p = [&](std::size_t i) {
                    return Vec3d(fine.positions[fine.tetra[t].vertices[i]]);
                };
                ASSERT_NEAR(volume6(p(0), p(1), p(2), p(3)), part, 1e-3 * part);
            }
        }
    }
}

TEST(PrintedMarch, CutsAlongTheShortestDiagonalAsTheRefinementDoes) {
    const TetraMesh mesh = shuffled(bent(bcc_block({3, 3, 3}, 1, {0, 0, 0}), 0.15f, 7), 8);
    HostExecutor exec;
    const TetraMesh fine = as_mesh(subdivided(exec, mesh, 1));
    const TetraRefinement refinement(mesh, 1);
    const TetraMesh expected = fine_mesh(refinement);
    const auto sorted = [](const TetraMesh& m) {
        std::set<Tetra> out;
        for (Tetra t : m.tetra) {
            std::ranges::sort(t);
            out.insert(t);
        }
        return out;
    };
    EXPECT_EQ(sorted(fine), sorted(expected)) << "vertices have the same numbers";
    ASSERT_EQ(fine.positions.size(), expected.positions.size());
    for (std::size_t v = 0; v < fine.positions.size(); ++v)
        ASSERT_LT(distance(fine.positions[v], expected.positions[v]), 1e-6f);
}

TEST(PrintedMarch, NamesARegionThatHasEachVertex) {
    const TetraMesh mesh = bent(bcc_block({3, 3, 3}, 1, {0, 0, 0}), 0.1f, 9);
    HostExecutor exec;
    const ExplicitTetra fine = subdivided(exec, mesh, 2);
    std::vector<std::set<std::uint32_t>> regions(fine.positions.size());
    for (std::size_t t = 0; t < fine.tetra.size(); ++t) {
        const auto coarse = static_cast<std::uint32_t>(t >> 6);
        const auto region = std::ranges::upper_bound(mesh.first, coarse) - mesh.first.begin() - 1;
        EXPECT_EQ(fine.tetra[t].region, region);
        for (const std::uint32_t v : fine.tetra[t].vertices)
            regions[v].insert(static_cast<std::uint32_t>(region));
    }
    for (std::size_t v = 0; v < regions.size(); ++v) ASSERT_TRUE(regions[v].contains(fine.regions[v]));
}

TEST(PrintedMarch, MakesTheTrianglesOfMarchingWithoutSnapping) {
    const TetraMesh mesh = shuffled(bent(bcc_block({5, 5, 5}, 1, {0, 0, 0}), 0.1f, 21), 22);
    const AnyField field{[](Vec3 p) {
        return std::max(1.1f - distance(p, {2.3f, 2.4f, 2.2f}),
                        0.9f - 1.3f * distance(p, {2.9f, 3.0f, 2.7f}));
    }};
    for (int levels = 0; levels <= 3; ++levels) {
        SCOPED_TRACE(levels);
        HostExecutor exec(Context{.threads = 2});
        const auto found = cuda::march_as_printed(exec, cuda::upload_explicit(exec, mesh), levels,
                                                  PointField<AnyField>{&field}, 0.0f, true);
        TriMesh welded;
        welded.positions.assign(found.positions.begin(), found.positions.end());
        welded.triangles.assign(found.welded.begin(), found.welded.end());
        ASSERT_EQ(found.triangles.size(), welded.triangles.size());
        for (std::size_t i = 0; i < welded.triangles.size(); ++i) {
            for (std::size_t k = 0; k < 3; ++k)
                ASSERT_EQ(found.triangles[i][k], welded.positions[welded.triangles[i][k]]);
        }
        const TopologyReport topo = topology(polygons(welded));
        EXPECT_TRUE(topo.watertight());
        EXPECT_EQ(topo.vertices, welded.positions.size());
        EXPECT_EQ(topo.euler, 2);
        const MarchResult expected =
            march(mesh, FieldRef(field), {.levels = levels, .snap = 0, .refinements = 0});
        EXPECT_NEAR(volume(welded), volume(expected.mesh), 2e-3 * volume(expected.mesh));
        if (levels > 1) continue;  // the shortest diagonal of a descendant may be another one
        EXPECT_EQ(welded.positions.size(), expected.mesh.positions.size());
        EXPECT_EQ(welded.triangles.size(), expected.mesh.triangles.size());
        for (const Vec3 p : welded.positions) {
            const auto near = std::ranges::min_element(expected.mesh.positions, {},
                                                       [&](Vec3 q) { return length_squared(q - p); });
            ASSERT_LT(distance(*near, p), 0.02f) << "except for the clearance of edges";
        }
    }
}

TEST(PrintedMarch, LeavesTheWeldOut) {
    const TetraMesh mesh = bcc_block({4, 4, 4}, 1, {0, 0, 0});
    const KernelField field = ball_field({2.1f, 2, 2}, 0.8f);
    HostExecutor exec;
    const auto found = cuda::march_as_printed(exec, cuda::upload_explicit(exec, mesh), 2,
                                              PointField<KernelField>{&field}, 1.0f, false);
    EXPECT_GT(found.triangles.size(), 100u);
    EXPECT_TRUE(found.welded.empty());
    EXPECT_TRUE(found.positions.empty());
}

TEST(DeviceMarcher, SaysThatThereIsNoCard) {
    if (find_device().device) GTEST_SKIP() << "there is a device";
    EXPECT_THROW(DeviceMarcher(), DeviceError);
}

}  // namespace
}  // namespace coppice
