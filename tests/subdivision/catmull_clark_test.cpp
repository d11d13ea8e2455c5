#include "coppice/subdivision/catmull_clark.h"

#include <gtest/gtest.h>
#include <opensubdiv/far/primvarRefiner.h>
#include <opensubdiv/far/topologyDescriptor.h>
#include <opensubdiv/far/topologyRefinerFactory.h>

#include <cstring>
#include <memory>

#include "coppice/base/error.h"
#include "errors.h"
#include "subdivision/cages.h"
#include "subdivision/match.h"

namespace coppice {
namespace {

namespace Far = OpenSubdiv::Far;
namespace Sdc = OpenSubdiv::Sdc;

// A vertex in the form that OpenSubdiv requires.
struct OsdPoint {
    Vec3 value;
    void Clear() { value = {}; }
    void AddWithWeight(const OsdPoint& other, float weight) { value += other.value * weight; }
};

QuadMesh refine_with_opensubdiv(const Cage& cage, int levels) {
    const std::vector<int> sizes(cage.quads.size(), 4);
    std::vector<int> corners;
    for (const Quad& q : cage.quads) corners.insert(corners.end(), q.begin(), q.end());
    Far::TopologyDescriptor descriptor;
    descriptor.numVertices = static_cast<int>(cage.points.size());
    descriptor.numFaces = static_cast<int>(cage.quads.size());
    descriptor.numVertsPerFace = sizes.data();
    descriptor.vertIndicesPerFace = corners.data();
    Sdc::Options rules;
    rules.SetVtxBoundaryInterpolation(Sdc::Options::VTX_BOUNDARY_EDGE_ONLY);
    using Factory = Far::TopologyRefinerFactory<Far::TopologyDescriptor>;
    const std::unique_ptr<Far::TopologyRefiner> refiner(
        Factory::Create(descriptor, Factory::Options(Sdc::SCHEME_CATMARK, rules)));
    Far::TopologyRefiner::UniformOptions uniform(levels);
    uniform.fullTopologyInLastLevel = true;
    refiner->RefineUniform(uniform);
    std::vector<OsdPoint> points(static_cast<std::size_t>(refiner->GetNumVerticesTotal()));
    for (std::size_t v = 0; v < cage.points.size(); ++v) points[v].value = cage.points[v];
    OsdPoint* from = points.data();
    for (int level = 1; level <= levels; ++level) {
        OsdPoint* to = from + refiner->GetLevel(level - 1).GetNumVertices();
        Far::PrimvarRefiner(*refiner).Interpolate(level, from, to);
        from = to;
    }
    QuadMesh mesh;
    const Far::TopologyLevel last = refiner->GetLevel(levels);
    for (int v = 0; v < last.GetNumVertices(); ++v) mesh.positions.push_back(from[v].value);
    for (int f = 0; f < last.GetNumFaces(); ++f) {
        const Far::ConstIndexArray q = last.GetFaceVertices(f);
        Quad quad;
        for (int k = 0; k < 4; ++k) quad[static_cast<std::size_t>(k)] = static_cast<std::uint32_t>(q[k]);
        mesh.quads.push_back(quad);
    }
    return mesh;
}

float measure_size(const Cage& cage) {
    Box3 box;
    for (const Vec3& p : cage.points) box.extend(p);
    return box.diagonal();
}

void expect_equal_to_opensubdiv(const Cage& cage, int levels) {
    const QuadMesh expected = refine_with_opensubdiv(cage, levels);
    const PatchRefinement patches(cage.quads, cage.vertex_count(), levels);
    const Buffer<Vec3> points = patches.refine(cage.points);
    ASSERT_EQ(points.size(), expected.positions.size());
    ASSERT_EQ(patches.vertex_count(), points.size());
    const auto map = match_points(points, expected.positions, 1e-5f * measure_size(cage));
    ASSERT_EQ(std::count(map.begin(), map.end(), points.size()), 0) << "a vertex has no counterpart";
    EXPECT_EQ(canonical_quads(patches.quads(), map), canonical_quads(expected.quads));
}

TEST(PatchRefinement, MatchesOpenSubdiv) {
    for (const auto& [name, cage] : cage_zoo()) {
        for (int levels = 0; levels <= 4; ++levels) {
            SCOPED_TRACE(name + ", levels " + std::to_string(levels));
            expect_equal_to_opensubdiv(cage, levels);
        }
    }
}

TEST(PatchRefinement, MatchesOpenSubdivAtAHubOfThousands) {
    expect_equal_to_opensubdiv(shaken(hub_cage(2000), 1e-4f), 1);
}

TEST(PatchRefinement, QuadsOfACageQuadAreAGrid) {
    const Cage cage = branching_cage();
    const PatchRefinement patches(cage.quads, cage.vertex_count(), 3);
    const Buffer<Quad> quads = patches.quads();
    ASSERT_EQ(quads.size(), 64 * cage.quads.size());
    for (std::size_t f = 0; f < cage.quads.size(); ++f) {
        EXPECT_EQ(quads[64 * f][0], cage.quads[f][0]);
        EXPECT_EQ(quads[64 * f + 7][1], cage.quads[f][1]);
        EXPECT_EQ(quads[64 * f + 63][2], cage.quads[f][2]);
        EXPECT_EQ(quads[64 * f + 56][3], cage.quads[f][3]);
        for (std::size_t k = 0; k < 64; ++k) {
            if (k % 8 < 7) {
                EXPECT_EQ(quads[64 * f + k][1], quads[64 * f + k + 1][0]);
            }
            if (k < 56) {
                EXPECT_EQ(quads[64 * f + k][2], quads[64 * f + k + 8][1]);
            }
        }
    }
}

TEST(PatchRefinement, EveryVertexHasOneOwner) {
    for (const auto& [name, cage] : cage_zoo()) {
        for (int levels = 0; levels <= 3; ++levels) {
            SCOPED_TRACE(name + ", levels " + std::to_string(levels));
            const PatchRefinement patches(cage.quads, cage.vertex_count(), levels);
            std::vector<int> owners(patches.vertex_count());
            const Buffer<std::uint32_t> owner = patches.owners();
            std::vector<std::uint32_t> owned(patches.max_owned());
            const Buffer<Quad> quads = patches.quads();
            for (std::uint32_t f = 0; f < cage.quads.size(); ++f) {
                const std::uint32_t count = patches.owned_vertices(f, owned);
                for (std::uint32_t k = 0; k < count; ++k) {
                    ++owners[owned[k]];
                    EXPECT_EQ(owner[owned[k]], f);
                    const auto* first = quads[f << (2 * levels)].data();
                    EXPECT_NE(std::find(first, first + (4u << (2 * levels)), owned[k]),
                              first + (4u << (2 * levels)));
                }
            }
            EXPECT_EQ(std::count(owners.begin(), owners.end(), 1), static_cast<long>(owners.size()));
        }
    }
}

TEST(PatchRefinement, EdgesAndVerticesOfTheCageHaveOneOwner) {
    for (const auto& [name, cage] : cage_zoo()) {
        SCOPED_TRACE(name);
        const PatchRefinement patches(cage.quads, cage.vertex_count(), 0);
        const CageView view = patches.cage();
        std::uint32_t edges = 0, vertices = 0;
        for (std::uint32_t h = 0; h < 4 * view.face_count(); ++h) {
            edges += view.owns_edge(h) ? 1u : 0u;
            vertices += view.owns_vertex(h) ? 1u : 0u;
        }
        EXPECT_EQ(edges, view.edge_count());
        EXPECT_EQ(vertices, view.vertex_count());
    }
}

TEST(PatchRefinement, MarksBoundaryVertices) {
    const Cage cage = grid_cage(4, 3, false);  // 5 x 4 vertices, 3 x 2 of them inside
    const PatchRefinement patches(cage.quads, cage.vertex_count(), 0);
    EXPECT_FALSE(patches.cage().closed());
    EXPECT_EQ(std::ranges::count(patches.cage().on_boundary, 1), 20 - 6);
    EXPECT_TRUE(PatchRefinement(hub_cage(3).quads, 8, 0).cage().closed());
}

TEST(PatchRefinement, IsBitIdenticalForAnyNumberOfThreads) {
    const Cage cage = shaken(grid_cage(150, 120, true), 0.01f);
    const auto bits = [&](unsigned threads) {
        Context ctx;
        ctx.threads = threads;
        const PatchRefinement patches(cage.quads, cage.vertex_count(), 2, ctx);
        return std::pair{patches.refine(cage.points, ctx), patches.quads(ctx)};
    };
    const auto one = bits(1);
    for (const unsigned threads : {2u, 7u}) {
        const auto many = bits(threads);
        EXPECT_EQ(std::memcmp(one.first.data(), many.first.data(), one.first.size() * sizeof(Vec3)), 0);
        EXPECT_EQ(one.second, many.second);
    }
}

// Radii of the limit section of a long prism with corner radius 1, at its corners and midway between them:
// the closed cubic B-spline of the polygon.
TEST(PatchRefinement, PrismsConvergeToTheirBSpline) {
    struct Prism {
        std::uint32_t sides;
        float at_corner, between;
    };
    for (const Prism& prism :
         {Prism{4, 0.667f, 0.648f}, Prism{6, 0.833f, 0.830f}, Prism{8, 0.902f, 0.901f}}) {
        SCOPED_TRACE(prism.sides);
        const Cage cage = tube_cage(9, prism.sides, 1, 1, false);
        const PatchRefinement patches(cage.quads, cage.vertex_count(), 5);
        const Buffer<Vec3> points = patches.refine(cage.points);
        const Buffer<Quad> quads = patches.quads();
        const std::size_t face = 4 * prism.sides;  // its lower side is on the middle ring
        const Vec3 corner = points[quads[face << 10][0]];
        const Vec3 between = points[quads[(face << 10) + 16][0]];
        EXPECT_NEAR(std::hypot(corner.x, corner.y), prism.at_corner, 1e-3f);
        EXPECT_NEAR(std::hypot(between.x, between.y), prism.between, 1e-3f);
    }
}

TEST(PatchRefinement, PreservesVerticesWithoutQuads) {
    const std::vector<Quad> quad = {{0, 1, 2, 3}};
    const std::vector<Vec3> points = {{0, 0, 0}, {1, 0, 0}, {1, 1, 0}, {0, 1, 0}, {5, 6, 7}};
    EXPECT_EQ(PatchRefinement(quad, 5, 2).refine(points)[4], (Vec3{5, 6, 7}));
}

TEST(PatchRefinement, AcceptsEmptyInput) {
    const PatchRefinement patches({}, 0, 3);
    EXPECT_TRUE(patches.quads().empty());
    EXPECT_TRUE(patches.refine({}).empty());
}

TEST(PatchRefinement, RejectsUnsupportedLevelsAndSizes) {
    const Cage cage = hub_cage(3);
    EXPECT_THROW(PatchRefinement(cage.quads, 8, -1), InvalidInput);
    EXPECT_THROW(PatchRefinement(cage.quads, 8, 7), InvalidInput);
    // 6 levels make 4096 quads of one: 2^31 is exceeded from 524,289 cage quads on, before these are checked.
    const std::vector<Quad> many(524289, Quad{0, 1, 2, 3});
    EXPECT_NE(test::error_of([&] { PatchRefinement(many, 8, 6); }).find("fewer levels"), std::string::npos);
}

TEST(PatchRefinement, RefusesCagesThatAreNotManifold) {
    const auto error_of = [](const std::vector<Quad>& quads, std::uint32_t vertices) {
        return test::error_of([&] { PatchRefinement(quads, vertices, 0); });
    };
    EXPECT_NE(error_of({{0, 1, 2, 9}}, 4).find("quad 0"), std::string::npos);
    EXPECT_NE(error_of({{0, 1, 2, 3}, {0, 1, 1, 3}}, 4).find("quad 1"), std::string::npos);
    EXPECT_NE(error_of({{0, 1, 0, 3}}, 4).find("quad 0"), std::string::npos);
    // Three faces on edge 0-1.
    EXPECT_NE(error_of({{0, 1, 2, 3}, {1, 0, 4, 5}, {0, 1, 6, 7}}, 8).find("edge 0-1"), std::string::npos);
    // Two faces with the same direction along edge 0-1.
    EXPECT_NE(error_of({{0, 1, 2, 3}, {0, 1, 4, 5}}, 6).find("edge 0-1"), std::string::npos);
    EXPECT_NE(error_of({{0, 1, 2, 3}, {5, 4, 1, 0}, {4, 6, 7, 0}, {0, 4, 1, 6}}, 8).find("edge"),
              std::string::npos);
}

}  // namespace
}  // namespace coppice
