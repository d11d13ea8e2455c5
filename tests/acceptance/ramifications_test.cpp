#include <gtest/gtest.h>

#include "coppice/io_skeleton/reader.h"
#include "coppice/measure/intersections.h"
#include "coppice/mesh/topology.h"
#include "coppice/pipeline/mesh_skeleton.h"
#include "support.h"
#include "zoo.h"

namespace coppice {
namespace {

QuadSurface ramified(const Skeleton& skeleton, MeshOptions options = {}) {
    options.method = MeshMethod::ramifications;
    return std::move(mesh_skeleton(skeleton, options).quads());
}

// Expects one sphere for each tree that does not begin inside another one, except merged ones.
void expect_spheres(const QuadSurface& surface, const Skeleton& skeleton) {
    const TopologyReport t = topology(surface.mesh);
    const std::uint32_t trees = skeleton.tree_count() - surface.grafted.joined;
    EXPECT_TRUE(t.watertight());
    EXPECT_EQ(t.components, surface.repair.parts);
    EXPECT_EQ(t.euler, 2 * (std::int64_t{trees} - std::ssize(surface.cage.joins)));
}

// Closed and without self-intersections, although remeshing may have joined touching surfaces.
void expect_sound(const QuadSurface& surface) {
    const TopologyReport t = topology(surface.mesh);
    EXPECT_TRUE(t.watertight());
    if (surface.repair.rounds > 0) {
        EXPECT_EQ(t.components, surface.repair.parts);
    }
    EXPECT_TRUE(crossing_faces(SurfaceTree(to_polygons(surface.mesh)), 1000).pairs.empty());
}

TEST(Ramifications, AreClosedOnTheZoo) {
    for (const auto& [name, skeleton] : skeleton_zoo()) {
        SCOPED_TRACE(name);
        expect_sound(ramified(skeleton));
        expect_spheres(ramified(skeleton, {.remesh_rounds = 0}), skeleton);
        MeshOptions pasted{.levels = 1};
        pasted.ramification.all_additional = true;
        expect_spheres(ramified(skeleton, pasted), skeleton);
    }
}

TEST(Metaballs, AreClosedOnTheZoo) {
    for (const auto& [name, skeleton] : skeleton_zoo()) {
        SCOPED_TRACE(name);
        // Without remeshing, which may join touching surfaces.
        for (const float bulge : {0.02f, 0.5f}) {
            const MeshOptions options{
                .method = MeshMethod::bmesh, .field = {.ball_bulge = bulge}, .remesh_rounds = 0};
            expect_spheres(mesh_skeleton(skeleton, options).quads(), skeleton);
        }
    }
}

// Before remeshing, which may join touching surfaces.
TEST(Ramifications, AreClosedOnFiles) {
    const auto files = test::skeleton_files();
    if (files.empty()) GTEST_SKIP() << "there is no ../shared";
    for (const auto& file : files) {
        SCOPED_TRACE(file.filename());
        const Skeleton skeleton = read_skeleton(file).skeleton;
        expect_spheres(ramified(skeleton, {.levels = 1, .remesh_rounds = 0}), skeleton);
    }
}

TEST(Ramifications, HaveNoSelfIntersectionsOnFiles) {
    const auto files = test::skeleton_files();
    if (files.empty()) GTEST_SKIP() << "there is no ../shared";
    for (const auto& file : files) {
        SCOPED_TRACE(file.filename());
        const QuadSurface surface = ramified(read_skeleton(file).skeleton);
        expect_sound(surface);
        EXPECT_LE(surface.ramified->after.total(), surface.ramified->before.total());
    }
}

TEST(Ramifications, AreOneSpherePerTreeOnRandomTrees) {
    for (const char* name : {"tree300", "tree3k"}) {
        if (!test::fs::exists(test::workload(name))) GTEST_SKIP() << "there is no ../shared";
        SCOPED_TRACE(name);
        const Skeleton skeleton = read_skeleton(test::workload(name)).skeleton;
        MeshOptions options;
        options.field.radius_scale = 1;  // thicker branches of tree3k touch
        const QuadSurface surface = ramified(skeleton, options);
        expect_spheres(surface, skeleton);
        EXPECT_LT(surface.ramified->after.total(), surface.ramified->before.total());
    }
}

}  // namespace
}  // namespace coppice
