// Checks whether a surface is closed, valid, and as thick as its skeleton.

#include <cstdio>

#include "coppice/measure/surface_report.h"
#include "coppice/pipeline/mesh_skeleton.h"
#include "coppice/skeleton/random_tree.h"

int main() {
    const coppice::Skeleton tree = coppice::random_tree(300, /*seed=*/1);
    const coppice::MeshResult result = coppice::mesh_skeleton(tree);
    const coppice::PolygonMesh mesh = coppice::to_polygons(result.quads().mesh);

    const coppice::SurfaceReport report = coppice::check_surface(mesh, &tree);
    std::printf("sound: %s\n", report.sound() ? "yes" : "no");
    std::printf("open edges %llu, Euler characteristic %lld\n",
                (unsigned long long)report.topology.open_edges, (long long)report.topology.euler);
    std::printf("intersecting faces: %llu\n", (unsigned long long)report.intersections->total);
    std::printf("folded faces: %llu\n", (unsigned long long)report.shape.inverted_faces);
    std::printf("radius off by %.1f %% on average\n", 100 * report.radius->regular.mean_abs);

    // A hole: the same mesh without its last face.
    coppice::PolygonMesh torn = mesh;
    torn.corners.resize(torn.corners.size() - 4);
    torn.first.pop_back();
    std::printf("without a face: %llu open edges\n",
                (unsigned long long)coppice::check_surface(torn, nullptr).topology.open_edges);
}
