#include <gtest/gtest.h>

#include <cmath>
#include <string>
#include <vector>

#include "acceptance/support.h"
#include "coppice/base/hash.h"
#include "coppice/io_skeleton/reader.h"
#include "coppice/measure/surface_report.h"
#include "coppice/pipeline/mesh_skeleton.h"
#include "coppice/skeleton/random_tree.h"
#include "zoo.h"

// The whole pipeline from skeleton to triangles by tetrahedra, compared with its promises.

namespace coppice {
namespace {

using namespace test;

MeshOptions tetrahedra(int levels = 1) {
    MeshOptions options;
    options.method = MeshMethod::tetrahedra;
    options.tetra.march.levels = levels;
    return options;
}

MeshOptions polyhedron(float edge) {
    MeshOptions options = tetrahedra();
    options.tetra.base = TetraBase::polyhedron;
    options.tetra.edge = edge;
    return options;
}

PolygonMesh make_surface(const Skeleton& skeleton, const MeshOptions& options) {
    return to_polygons(mesh_skeleton(skeleton, options).tetrahedra().mesh);
}

SurfaceReport judge(const Skeleton& skeleton, const MeshOptions& options = tetrahedra()) {
    return check_surface(make_surface(skeleton, options), &skeleton);
}

/// Checks the surface alone, which takes half of the time.
SurfaceReport judge_alone(const Skeleton& skeleton, const MeshOptions& options) {
    return check_surface(make_surface(skeleton, options), nullptr);
}

/// Expects a closed, manifold, outwards oriented surface without self-intersections.
void expect_solid(const SurfaceReport& r) {
    EXPECT_TRUE(r.sound()) << r.topology.open_edges << " open, " << r.topology.non_manifold_edges
                           << " non-manifold and " << r.topology.misoriented_edges << " misoriented edges, "
                           << r.topology.non_manifold_vertices << " non-manifold vertices";
    EXPECT_EQ(r.intersections->total, 0u);
    EXPECT_GT(r.shape.signed_volume, 0);
}

TEST(AcceptanceTetra, EverySkeletonInTheZooHasAWatertightSolid) {
    for (const int levels : {0, 1, 2}) {
        for (const auto& [name, skeleton] : skeleton_zoo()) {
            SCOPED_TRACE(name + ", level " + std::to_string(levels));
            expect_solid(judge_alone(skeleton, tetrahedra(levels)));
        }
    }
}

TEST(AcceptanceTetra, EverySkeletonInTheZooHasAWatertightSolidFromItsPolyhedron) {
    for (const float edge : {1.5f, 0.75f}) {
        for (const auto& [name, skeleton] : skeleton_zoo()) {
            SCOPED_TRACE(name + ", edge " + std::to_string(edge));
            const SurfaceReport r = judge_alone(skeleton, polyhedron(edge));
            expect_solid(r);
            EXPECT_LE(r.topology.components, skeleton.tree_count());
        }
    }
}

TEST(AcceptanceTetra, PolyhedronCountsMatchThePublishedOrderOfMagnitude) {
    // Rhus of [Zhu2013]: 2,064 tetrahedra, cut three times, and 362,740 triangles; the number of its segments
    // is not published.
    const TetraSurface surface = mesh_skeleton(random_tree(288, 1), polyhedron(0.5f)).tetrahedra();
    ASSERT_TRUE(surface.polyhedron);
    EXPECT_EQ(surface.march.tetra, 512u * surface.coarse);
    EXPECT_GT(surface.coarse, 2064u / 2);
    EXPECT_LT(surface.coarse, 2064u * 3);
    EXPECT_GT(surface.mesh.triangles.size(), 362'740u / 3);
    EXPECT_LT(surface.mesh.triangles.size(), 362'740u * 3);
}

TEST(AcceptanceTetra, PolyhedronSurfaceIsAccurate) {
    const SurfaceReport r = judge(random_tree(288, 1), polyhedron(0.5f));
    expect_solid(r);
    EXPECT_EQ(r.topology.components, 1u);
    EXPECT_EQ(r.axes->severed, 0u);
    EXPECT_LE(r.radius->regular.mean_abs, 0.01);
}

TEST(AcceptanceTetra, PolyhedronLevelsFollowTheEdgeLength) {
    const auto levels = [](float edge) { return polyhedron_levels(polyhedron(edge).tetra); };
    EXPECT_EQ(levels(4), 1);
    EXPECT_EQ(levels(1.5f), 1);
    EXPECT_EQ(levels(0.5f), 3);
    EXPECT_EQ(levels(0.375f), 3);
    EXPECT_EQ(levels(0.07f), 5);
    EXPECT_THROW(levels(0.06f), InvalidInput);
}

TEST(AcceptanceTetra, SurfaceContainsEverySegmentOfHardTrees) {
    for (const char* name :
         {"random_hard_2", "random_large_hard", "whorl_on_short_trunk", "thin_lateral_15"}) {
        SCOPED_TRACE(name);
        const SurfaceReport r = judge(zoo_skeleton(name));
        EXPECT_EQ(r.axes->severed, 0u);
    }
}

TEST(AcceptanceTetra, IntersectingBranchesBecomeOneBody) {
    // Two trees, each a bar through the middle of the other.
    const Skeleton cross({NodeId::none(), NodeId(0), NodeId::none(), NodeId(2)},
                         {{-2, 0, 0}, {2, 0, 0}, {0, -2, 0}, {0, 2, 0}}, {0.3f, 0.3f, 0.3f, 0.3f});
    const SurfaceReport r = judge(cross);
    expect_solid(r);
    EXPECT_EQ(r.topology.components, 1u);
    EXPECT_EQ(r.topology.euler, 2);
}

TEST(AcceptanceTetra, SeparateTreesRemainSeparateBodies) {
    const Skeleton apart({NodeId::none(), NodeId(0), NodeId::none(), NodeId(2)},
                         {{-2, 0, 0}, {2, 0, 0}, {-2, 1, 0}, {2, 1, 0}}, {0.3f, 0.3f, 0.3f, 0.3f});
    const SurfaceReport r = judge(apart);
    expect_solid(r);
    EXPECT_EQ(r.topology.components, 2u);
    EXPECT_EQ(r.topology.euler, 4);
}

TEST(AcceptanceTetra, FlatEndsAreInTheirPlanes) {
    const Skeleton bar({NodeId::none(), NodeId(0), NodeId(1)}, {{0, 0, 0}, {0, 0, 1}, {0, 0, 2}},
                       {0.25f, 0.25f, 0.25f});
    MeshOptions options = tetrahedra(3);
    options.tetra.edge = 0.15f;
    options.control.tips = TipShape::flat;
    const TriMesh mesh = mesh_skeleton(bar, options).tetrahedra().mesh;
    const SurfaceReport r = check_surface(to_polygons(mesh), nullptr);
    expect_solid(r);
    float low = 1, high = 0;
    for (const Vec3 p : mesh.positions) {
        low = std::min(low, p.z);
        high = std::max(high, p.z);
    }
    EXPECT_NEAR(low, 0, 1e-4);
    EXPECT_NEAR(high, 2, 1e-4);
    const double cylinder = 3.14159265 * 0.25 * 0.25 * 2;
    EXPECT_NEAR(r.shape.signed_volume / cylinder, 1, 0.02);
    options.control = {.base = BaseShape::round};
    const SurfaceReport round = judge_alone(bar, options);
    const double ball = 4.0 / 3 * 3.14159265 * 0.25 * 0.25 * 0.25;
    EXPECT_NEAR(round.shape.signed_volume / (cylinder + ball), 1, 0.04);
}

TEST(AcceptanceTetra, EdgeLengthIsIndependentOfLevels) {
    const Skeleton tree = random_tree(100, 3);
    for (const int levels : {1, 2, 3}) {
        MeshOptions options = tetrahedra(levels);
        const std::size_t coarse = mesh_skeleton(tree, options).tetrahedra().mesh.triangles.size();
        options.tetra.edge *= 0.5f;
        const std::size_t fine = mesh_skeleton(tree, options).tetrahedra().mesh.triangles.size();
        EXPECT_NEAR(static_cast<double>(fine) / static_cast<double>(coarse), 4, 1) << levels << " levels";
    }
}

TEST(AcceptanceTetra, IsBitIdenticalForAnyNumberOfThreads) {
    const auto hash = [](const Skeleton& s, unsigned threads) {
        const TriMesh mesh = mesh_skeleton(s, tetrahedra(), {.threads = threads}).tetrahedra().mesh;
        return Hash()
            .add(std::span<const Vec3>(mesh.positions))
            .add(std::span<const Triangle>(mesh.triangles))
            .value();
    };
    for (const char* name : {"soma", "forest", "random_hard_2", "random_large_hard"}) {
        SCOPED_TRACE(name);
        const Skeleton skeleton = zoo_skeleton(name);
        const std::uint64_t one = hash(skeleton, 1);
        for (const unsigned threads : {2u, 7u})
            EXPECT_EQ(hash(skeleton, threads), one) << threads << " threads";
    }
}

TEST(AcceptanceTetraFiles, EverySkeletonHasAWatertightSolidFromItsPolyhedron) {
    const std::vector<fs::path> files = skeleton_files();
    if (files.empty()) GTEST_SKIP() << "there is no " << kShared;
    for (const fs::path& file : files) {
        SCOPED_TRACE(file.filename());
        const Skeleton skeleton = read_skeleton(file).skeleton;
        expect_solid(judge_alone(skeleton, polyhedron(skeleton.size() > 2000 ? 1.5f : 0.75f)));
    }
}

TEST(AcceptanceTetraFiles, EverySkeletonHasAWatertightSolid) {
    const std::vector<fs::path> files = skeleton_files();
    if (files.empty()) GTEST_SKIP() << "there is no " << kShared;
    for (const fs::path& file : files) {
        SCOPED_TRACE(file.filename());
        const Skeleton skeleton = read_skeleton(file).skeleton;
        MeshOptions options = tetrahedra();
        // Millions of triangles would take a minute; the workloads below contain the usual ones in great
        // number.
        if (skeleton.size() > 2000) options.tetra.edge = 1;
        expect_solid(judge_alone(skeleton, options));
    }
}

class AcceptanceTetraWorkload : public testing::TestWithParam<const char*> {};

TEST_P(AcceptanceTetraWorkload, SurfaceIsAccurate) {
    if (!fs::exists(workload(GetParam()))) GTEST_SKIP() << "there is no " << workload(GetParam());
    const SurfaceReport r = judge(read_skeleton(workload(GetParam())).skeleton);
    expect_solid(r);
    EXPECT_LE(r.radius->regular.mean_abs, 0.012);
    EXPECT_EQ(r.axes->severed, 0u);
    // The minimum angle of one triangle in a hundred: the sine of 12 degrees over that of 60.
    EXPECT_GE(r.shape.scaled_jacobian.p1, 0.24);
}

INSTANTIATE_TEST_SUITE_P(Trees, AcceptanceTetraWorkload,
                         testing::Values("tree300", "tree300hard", "tree3k", "tree3khard"),
                         [](const auto& chosen) { return std::string(chosen.param); });

}  // namespace
}  // namespace coppice
