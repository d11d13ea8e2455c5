#include "coppice/pipeline/fit/kept_quads_internal.h"

#include <gtest/gtest.h>

#include "coppice/skeleton/random_tree.h"
#include "tube_row_search.h"

namespace coppice {
namespace {

using namespace test;

constexpr std::uint32_t kMany = 1'000'000;

/// Compares the crossings found in a surface with some displaced vertices, and in its remeshed quads.
std::size_t expect_all_found(const Skeleton& skeleton, float astray, const MeshOptions& options = {}) {
    const Quads before = quads_of(skeleton, options);
    const QuadMesh after = std::move(mesh_skeleton(skeleton, options).quads().mesh);
    pipeline_internal::KeptQuads kept({before.surface.mesh, before.tubes, before.levels}, before.surface.cage,
                                      after);
    std::size_t found = 0;
    for (const std::size_t step : {std::size_t{97}, std::size_t{1009}}) {
        PolygonMesh moved = to_polygons(after);
        for (std::size_t v = step / 2; v < moved.positions.size(); v += step) {
            const std::size_t other = (v + 1 + v % 50) % moved.positions.size();
            moved.positions[v] = lerp(moved.positions[v], moved.positions[other], astray);
        }
        const FacePairs all = crossing_faces(SurfaceTree(moved), kMany);
        EXPECT_EQ(kept.crossings(moved, kMany, {}).pairs, all.pairs);
        EXPECT_TRUE(all.complete);
        found += all.pairs.size();
    }
    return found;
}

TEST(KeptQuads, FindTheCrossingsOfTheWholeMesh) {
    // The first is not remeshed; the others in few and in many places.
    EXPECT_GT(expect_all_found(random_tree(300, 1), 0.5f), 100u);
    EXPECT_GT(expect_all_found(random_tree(150, 2, true), 0.5f), 100u);
    EXPECT_GT(expect_all_found(random_tree(150, 3, true), 1.5f), 1000u);
    MeshOptions options;
    options.method = MeshMethod::ramifications;
    EXPECT_GT(expect_all_found(random_tree(150, 3, true), 0.5f, options), 100u);
}

TEST(KeptQuads, StopAtTheLimit) {
    const Quads quads = quads_of(random_tree(100, 1), {});
    pipeline_internal::KeptQuads kept({quads.surface.mesh, quads.tubes, quads.levels}, quads.surface.cage,
                                      quads.surface.mesh);
    PolygonMesh moved = to_polygons(quads.surface.mesh);
    EXPECT_TRUE(kept.crossings(moved, 1, {}).pairs.empty());
    for (Vec3& p : moved.positions) p.z = 0;
    const FacePairs found = kept.crossings(moved, 1000, {});
    EXPECT_EQ(found.pairs.size(), 1000u);
    EXPECT_FALSE(found.complete);
}

}  // namespace
}  // namespace coppice
