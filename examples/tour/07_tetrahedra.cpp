// Branches that run through each other: quads keep one sphere per tree, tetrahedra make one body.

#include <cstdio>

#include "coppice/measure/surface_report.h"
#include "coppice/pipeline/mesh_skeleton.h"

int main() {
    using coppice::NodeId;
    using coppice::Vec3;

    // Two bars that cross in the middle; no node says so.
    const coppice::Skeleton cross({NodeId::none(), NodeId(0), NodeId::none(), NodeId(2)},
                                  {Vec3{-1, 0, 0}, Vec3{1, 0, 0}, Vec3{0, -1, 0}, Vec3{0, 1, 0}},
                                  {0.2f, 0.2f, 0.2f, 0.2f});

    const auto judge = [](const char* method, const coppice::PolygonMesh& mesh) {
        const coppice::SurfaceReport report = coppice::check_surface(mesh, nullptr);
        std::printf("%s: %u faces, sound %s, parts %llu, pairs of faces that cross %s\n", method,
                    mesh.face_count(), report.sound() ? "yes" : "no",
                    (unsigned long long)report.topology.components,
                    report.intersections->total == 0 ? "none" : "some");
    };

    const coppice::MeshResult quads = coppice::mesh_skeleton(cross);
    judge("quads", coppice::to_polygons(quads.quads().mesh));

    coppice::MeshOptions options{.method = coppice::MeshMethod::tetrahedra};
    options.tetra.edge = 0.3f;  // of the triangles, in radii
    const coppice::MeshResult triangles = coppice::mesh_skeleton(cross, options);
    judge("tetrahedra", coppice::to_polygons(triangles.tetrahedra().mesh));
}
