#include "coppice/pipeline/fit/kept_quads_internal.h"

#include <gtest/gtest.h>

#include "coppice/pipeline/mesh_skeleton.h"
#include "coppice/pipeline/quads/built_mesh_internal.h"
#include "coppice/skeleton/random_tree.h"

namespace coppice {
namespace {

constexpr std::uint32_t kMany = 1'000'000;

/// Compares the crossings found in a surface with some displaced vertices, and in its remeshed quads.
std::size_t expect_all_found(const Skeleton& skeleton, float astray, const MeshOptions& options = {}) {
    const pipeline_internal::BuiltMesh built = pipeline_internal::build_mesh(skeleton, options, {});
    const QuadMesh& after = built.result.quads().mesh;
    pipeline_internal::KeptQuads kept(built.build, {});
    std::size_t found = 0;
    for (const std::size_t step : {std::size_t{97}, std::size_t{1009}}) {
        PolygonMesh moved = to_polygons(after);
        for (std::size_t v = step / 2; v < moved.positions.size(); v += step) {
            const std::size_t other = (v + 1 + v % 50) % moved.positions.size();
            moved.positions[v] = lerp(moved.positions[v], moved.positions[other], astray);
        }
        const FacePairs all = crossing_faces(SurfaceTree(moved), kMany);
        EXPECT_EQ(kept.crossings(moved, built.build.tubes, kMany, {}).pairs, all.pairs);
        EXPECT_TRUE(all.complete);
        found += all.pairs.size();
    }
    return found;
}

TEST(KeptQuads, FindTheSelfIntersectionsOfTheWholeMesh) {
    // The first is not remeshed; the others in few and in many places.
    EXPECT_GT(expect_all_found(random_tree(300, 1), 0.5f), 100u);
    EXPECT_GT(expect_all_found(random_tree(150, 2, true), 0.5f), 100u);
    EXPECT_GT(expect_all_found(random_tree(150, 3, true), 1.5f), 1000u);
    MeshOptions options;
    options.method = MeshMethod::ramifications;
    EXPECT_GT(expect_all_found(random_tree(150, 3, true), 0.5f, options), 100u);
}

TEST(KeptQuads, StopAtTheLimit) {
    MeshOptions options;
    options.remesh_rounds = 0;
    const pipeline_internal::BuiltMesh built =
        pipeline_internal::build_mesh(random_tree(100, 1), options, {});
    const Skeleton& tubes = built.build.tubes;
    pipeline_internal::KeptQuads kept(built.build, {});
    PolygonMesh moved = to_polygons(built.result.quads().mesh);
    EXPECT_TRUE(kept.crossings(moved, tubes, 1, {}).pairs.empty());
    for (Vec3& p : moved.positions) p.z = 0;
    const FacePairs found = kept.crossings(moved, tubes, 1000, {});
    EXPECT_EQ(found.pairs.size(), 1000u);
    EXPECT_FALSE(found.complete);
}

}  // namespace
}  // namespace coppice
