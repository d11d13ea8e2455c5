// Reconstructs a skeleton from a surface, and from points on it.

#include <cstdio>

#include "coppice/extract/cloud/from_cloud.h"
#include "coppice/extract/mesh/from_mesh.h"
#include "coppice/measure/match/skeleton_match.h"
#include "coppice/pipeline/mesh_skeleton.h"
#include "coppice/points/sampling/near_mesh.h"
#include "coppice/skeleton/random_tree.h"

void judge(const char* what, const coppice::Skeleton& truth, const coppice::Skeleton& found) {
    const coppice::SkeletonMatch match = coppice::compare(truth, found);
    std::printf("%s: %.0f %% of the length covered, %.0f %% of the result correct\n", what,
                match.covered_percent, match.true_percent);
}

int main() {
    const coppice::Skeleton truth = coppice::random_tree(100, /*seed=*/1);
    const coppice::QuadMesh surface = coppice::mesh_skeleton(truth).quads().mesh;

    const auto from_mesh = coppice::extract_from_mesh(coppice::to_polygons(surface));
    judge("from the mesh", truth, from_mesh.skeleton);

    // Points distributed over the surface, as by a scan from all sides.
    const coppice::PointSet cloud =
        coppice::near_mesh(coppice::triangulate(surface), {.count = 50'000, .low = 0, .high = 0});
    const auto from_cloud = coppice::extract_from_cloud(cloud);
    judge("from 50,000 points", truth, from_cloud.skeleton);
}
