#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <set>
#include <vector>

#include "coppice/cuda/exec/host_executor_internal.h"
#include "coppice/cuda/field/upload_field_internal.h"
#include "coppice/mesh/topology.h"
#include "coppice/skeleton/random_tree.h"
#include "cuda/march_support.h"
#include "cuda/on_executor.h"
#include "cuda/strict_executor.h"
#include "cuda/tetra_scene.h"
#include "printed_march_stages.h"
#include "tetra/support.h"
#include "tetra/surfaces.h"

// Tests of marching as published in [Zhu2013], with the device kernels run on the CPU.

namespace coppice::bench {
namespace {

using cuda::HostExecutor;

/// Returns the subdivision of the coarse mesh as published, without a field.
ExplicitTetra subdivided(HostExecutor& exec, const TetraMesh& mesh, int levels) {
    ExplicitTetra out = upload_explicit(exec, mesh);
    for (int l = 0; l < levels; ++l) out = subdivide(exec, out);
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

TEST(PrintedMarch, SubdividesIntoEightEqualVolumes) {
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

TEST(PrintedMarch, SubdividesAlongTheShortestDiagonalAsTheRefinementDoes) {
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

TEST(PrintedMarch, RegionOfAVertexContainsIt) {
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

TEST(PrintedMarch, TrianglesMatchMarchWithoutSnapping) {
    const TetraMesh mesh = shuffled(bent(bcc_block({5, 5, 5}, 1, {0, 0, 0}), 0.1f, 21), 22);
    const AnyField field{[](Vec3 p) {
        return std::max(1.1f - distance(p, {2.3f, 2.4f, 2.2f}),
                        0.9f - 1.3f * distance(p, {2.9f, 3.0f, 2.7f}));
    }};
    for (int levels = 0; levels <= 3; ++levels) {
        SCOPED_TRACE(levels);
        HostExecutor exec(Context{.threads = 2});
        const auto found = march_as_printed(exec, upload_explicit(exec, mesh), levels,
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

TEST(PrintedMarch, SkipsWeldingIfRequested) {
    const TetraMesh mesh = bcc_block({4, 4, 4}, 1, {0, 0, 0});
    const KernelField field = ball_field({2.1f, 2, 2}, 0.8f);
    HostExecutor exec;
    const auto found =
        march_as_printed(exec, upload_explicit(exec, mesh), 2, PointField<KernelField>{&field}, 1.0f, false);
    EXPECT_GT(found.triangles.size(), 100u);
    EXPECT_TRUE(found.welded.empty());
    EXPECT_TRUE(found.positions.empty());
}

struct Printed {
    Buffer<std::array<Vec3, 3>> triangles;
    Buffer<Vec3> positions;
    Buffer<Triangle> welded;
};

template <class Exec>
Printed printed(const CutScene& scene) {
    Exec exec;
    const ConvolutionField& field = scene.tetra.field;
    const kernel::QuarticKernel<float> formula(field.kernel().shape, field.kernel().weight);
    const cuda::FieldView segments(formula, cuda::upload_field(exec, field));
    const auto view = cuda::upload_cuts(exec, segments, scene.ends, field.level());
    const ExplicitTetra coarse = upload_explicit(exec, scene.mesh());
    const PrintedSurface found =
        march_as_printed(exec, coarse, scene.options.levels, view, field.level(), true);
    return {cuda::downloaded(exec, found.triangles), cuda::downloaded(exec, found.positions),
            cuda::downloaded(exec, found.welded)};
}

TEST(PrintedMarch, MatchesTheHostExecutorOnTheStrictOne) {
    const CutScene scene(random_tree(60, 4, true), 1, 0.6f);
    const Printed host = printed<HostExecutor>(scene), strict = printed<cuda::StrictExecutor>(scene);
    ASSERT_GT(host.triangles.size(), 100u);
    EXPECT_EQ(strict.triangles, host.triangles);
    EXPECT_EQ(strict.positions, host.positions);
    EXPECT_EQ(strict.welded, host.welded);
}

}  // namespace
}  // namespace coppice::bench
