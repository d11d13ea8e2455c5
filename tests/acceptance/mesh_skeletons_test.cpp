// Skeletons that are extracted again from their own surfaces.

#include <gtest/gtest.h>

#include "acceptance/support.h"
#include "coppice/extract/mesh/from_mesh.h"
#include "coppice/io_skeleton/reader.h"
#include "coppice/measure/match/skeleton_match.h"
#include "coppice/pipeline/mesh_skeleton.h"

namespace coppice::test {
namespace {

// Twigs of twelve radii next to a stem fifteen times as thick: the contraction of the stem must not shorten
// the twigs.
TEST(AcceptanceMeshSkeletons, BothMethodsExtractTheTwigsOfAnOak) {
    const Skeleton oak = read_skeleton(source_dir() / "examples/oak.swc").skeleton;
    const PolygonMesh surface = to_polygons(mesh_skeleton(oak).quads().mesh);
    for (const MeshSkeletonMethod method : {MeshSkeletonMethod::rings, MeshSkeletonMethod::contraction}) {
        FromMeshOptions options;
        options.method = method;
        const SkeletonMatch match = compare(oak, extract_from_mesh(surface, options).skeleton);
        EXPECT_GE(match.tips.percent(), 97) << name_of(method);
        EXPECT_GE(match.junctions.percent(), 95) << name_of(method);
        EXPECT_GE(match.covered_percent, 99) << name_of(method);
        EXPECT_GE(match.true_percent, 99) << name_of(method);
    }
}

}  // namespace
}  // namespace coppice::test
