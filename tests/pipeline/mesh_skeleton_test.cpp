#include "coppice/pipeline/mesh_skeleton.h"

#include <gtest/gtest.h>

#include <cmath>

#include "coppice/measure/intersections.h"
#include "coppice/mesh/topology.h"
#include "coppice/skeleton/random_tree.h"
#include "errors.h"

namespace coppice {
namespace {

Skeleton cone(Vec3 top, float radius, float radius_at_top) {
    return Skeleton({NodeId::none(), NodeId(0)}, {{0, 0, 0}, top}, {radius, radius_at_top});
}

MeshOptions by(MeshMethod method) {
    MeshOptions options;
    options.method = method;
    return options;
}

TEST(MeshSkeleton, HasTheSurfaceOfItsMethodOnly) {
    const Skeleton bar = cone({0, 0, 2}, 0.3f, 0.2f);
    const MeshResult quads = mesh_skeleton(bar, by(MeshMethod::quads));
    EXPECT_EQ(quads.surface.index(), static_cast<std::size_t>(MeshMethod::quads));
    EXPECT_FALSE(quads.quads().mesh.quads.empty());
    EXPECT_FALSE(quads.quads().cage.cage.quads.empty());
    EXPECT_THROW(static_cast<void>(quads.tetrahedra()), std::bad_variant_access);
    const MeshResult triangles = mesh_skeleton(bar, by(MeshMethod::tetrahedra));
    EXPECT_EQ(triangles.surface.index(), static_cast<std::size_t>(MeshMethod::tetrahedra));
    EXPECT_FALSE(triangles.tetrahedra().mesh.triangles.empty());
    EXPECT_GT(triangles.tetrahedra().march.crossed, 0u);
    EXPECT_THROW(static_cast<void>(triangles.quads()), std::bad_variant_access);
}

// Hundreds of spokes from one node; those of a brush, each from a separate node, are accepted.
TEST(MeshSkeleton, RejectsHundredsOfBranchesAtOneNode) {
    constexpr std::uint32_t kSpokes = 300;
    std::vector<NodeId> parent{NodeId::none()};
    std::vector<Vec3> position{{0, 0, 1}};
    for (std::uint32_t i = 0; i < kSpokes; ++i) {
        const float a = 0.5f * static_cast<float>(i);
        parent.emplace_back(0u);
        position.push_back({3 * std::cos(a), 3 * std::sin(a), 0.01f * static_cast<float>(i)});
    }
    const Skeleton star(parent, position, std::vector<float>(kSpokes + 1, 0.1f));
    for (const MeshMethod method : {MeshMethod::quads, MeshMethod::tetrahedra}) {
        EXPECT_EQ(
            test::error_of([&] { static_cast<void>(mesh_skeleton(star, by(method))); }),
            "mesh: 300 branches begin at the node at 0 0 1, but a surface can join at most 256: let them "
            "begin at separate nodes along their parent, or use the method cylinders");
    }
    EXPECT_FALSE(mesh_skeleton(star, by(MeshMethod::cylinders)).cylinders().mesh.positions.empty());
}

TEST(MeshSkeleton, RamificationsAreQuadsWithAReport) {
    const Skeleton fork({NodeId::none(), NodeId(0), NodeId(1), NodeId(1)},
                        {{0, 0, 0}, {0, 0, 2}, {0, 0, 4}, {2, 0, 3}}, {0.3f, 0.3f, 0.25f, 0.1f});
    const MeshResult made = mesh_skeleton(fork, by(MeshMethod::ramifications));
    ASSERT_TRUE(made.quads().ramified);
    EXPECT_EQ(made.quads().ramified->connectable, 1u);
    EXPECT_EQ(made.quads().mesh.quads.size(), 4 * made.quads().cage.cage.quads.size());
    EXPECT_FALSE(mesh_skeleton(fork).quads().ramified);
    MeshOptions options = by(MeshMethod::ramifications);
    options.levels = 0;
    const std::string message = test::error_of([&] { mesh_skeleton(fork, options); });
    EXPECT_TRUE(message.starts_with("mesh: levels must be at least 1 for ramifications")) << message;
}

TEST(MeshSkeleton, RamificationsHaveNoSelfIntersections) {
    for (std::uint64_t seed = 1; seed <= 4; ++seed) {
        const QuadSurface made =
            mesh_skeleton(random_tree(300, seed, true), by(MeshMethod::ramifications)).quads();
        const PolygonMesh mesh = to_polygons(made.mesh);
        EXPECT_TRUE(topology(made.mesh).watertight());
        EXPECT_GT(made.repair.pairs_before, 0u);
        EXPECT_EQ(made.repair.pairs_after, 0u);
        EXPECT_TRUE(crossing_faces(SurfaceTree(mesh), 100'000).pairs.empty());
    }
}

TEST(MeshSkeleton, MetaballsBulgeUpToTheOption) {
    const Skeleton bar = cone({0, 0, 4}, 0.2f, 0.2f);
    MeshOptions options = by(MeshMethod::bmesh);
    options.levels = 4;
    options.prepare.resample.method = ResampleMethod::none;  // one segment with uniformly spaced balls
    options.field.ball_bulge = 0.12f;
    const QuadSurface surface = mesh_skeleton(bar, options).quads();
    ASSERT_TRUE(surface.balls);
    float least = 1, most = 0;
    for (const Vec3 p : surface.mesh.positions) {
        if (p.z < 0.6f || p.z > 3.4f) continue;  // beyond the ends' influence
        const float radius = std::hypot(p.x, p.y) / 0.2f;
        least = std::min(least, radius);
        most = std::max(most, radius);
    }
    EXPECT_GT(most - least, 0.08f);  // the spacing of whole balls is slightly less than the maximum
    EXPECT_LT(most - least, 0.121f);
    EXPECT_GE(surface.balls->balls, 20 / surface.balls->chain.spacing);
    EXPECT_FALSE(mesh_skeleton(bar).quads().balls);
}

TEST(MeshSkeleton, MetaballsIgnoreTheBlend) {
    MeshOptions options = by(MeshMethod::bmesh), same;
    same.field.kernel = Kernel::balls;
    same.field.blend = 1;
    const Skeleton tree = random_tree(60, 3, false);
    EXPECT_EQ(mesh_skeleton(tree, options).quads().mesh.positions,
              mesh_skeleton(tree, same).quads().mesh.positions);
    options.field.kernel = Kernel::cauchy;
    EXPECT_EQ(test::error_of([&] { mesh_skeleton(tree, options); }),
              "mesh: kernel must be quartic or balls for bmesh, which uses quartic balls");
}

TEST(MeshSkeleton, CylindersAreTubes) {
    const MeshResult made = mesh_skeleton(cone({0, 0, 2}, 0.3f, 0.2f), by(MeshMethod::cylinders));
    EXPECT_EQ(made.cylinders().report.tubes, 1u);
    EXPECT_EQ(made.cylinders().report.max_sides, 16u);
    EXPECT_EQ(to_polygons(made).face_count(), made.cylinders().mesh.face_count());
}

// With a flat base, the cone is a hundred times as wide as high: less than the cells of the lattice.
TEST(MeshSkeleton, RejectsASurfaceThinnerThanTheTetrahedra) {
    const Skeleton wide = cone({0, 0, 1}, 100, 0.001f);
    MeshOptions options = by(MeshMethod::tetrahedra);
    const std::string message = test::error_of([&] { mesh_skeleton(wide, options); });
    EXPECT_TRUE(message.starts_with("mesh: no surface is left")) << message;
    options.control.base = BaseShape::round;
    EXPECT_FALSE(mesh_skeleton(wide, options).tetrahedra().mesh.triangles.empty());
}

}  // namespace
}  // namespace coppice
