// Branches that run through each other: the surfaces may intersect, one branch may be grafted onto the other,
// or both are merged into one body, of quads or of triangles.

#include <cstdio>

#include "coppice/measure/surface_report.h"
#include "coppice/pipeline/mesh_skeleton.h"

int main() {
    using coppice::NodeId;
    using coppice::Vec3;

    // Two bars that intersect in the middle, without a common node.
    const coppice::Skeleton cross({NodeId::none(), NodeId(0), NodeId::none(), NodeId(2)},
                                  {Vec3{-1, 0, 0}, Vec3{1, 0, 0}, Vec3{0, -1, 0}, Vec3{0, 1, 0}},
                                  {0.2f, 0.2f, 0.2f, 0.2f});

    const auto judge = [](const char* method, const coppice::PolygonMesh& mesh) {
        const coppice::SurfaceReport report = coppice::check_surface(mesh, nullptr);
        std::printf("%s: %u faces, sound %s, components %llu, intersecting pairs of faces %s\n", method,
                    mesh.face_count(), report.sound() ? "yes" : "no",
                    (unsigned long long)report.topology.components,
                    report.intersections->total == 0 ? "none" : "some");
    };

    coppice::MeshOptions keep;
    keep.overlaps = coppice::Overlaps::keep;
    const coppice::MeshResult crossed = coppice::mesh_skeleton(cross, keep);
    judge("quads, kept", coppice::to_polygons(crossed.quads().mesh));

    coppice::MeshOptions graft;
    graft.overlaps = coppice::Overlaps::graft;
    const coppice::MeshResult grafted = coppice::mesh_skeleton(cross, graft);
    judge("quads, grafted", coppice::to_polygons(grafted.quads().mesh));

    const coppice::MeshResult merged = coppice::mesh_skeleton(cross);
    judge("quads, merged", coppice::to_polygons(merged.quads().mesh));

    coppice::MeshOptions options{.method = coppice::MeshMethod::tetrahedra};
    options.tetra.edge = 0.3f;  // of the triangles, in radii
    const coppice::MeshResult triangles = coppice::mesh_skeleton(cross, options);
    judge("tetrahedra", coppice::to_polygons(triangles.tetrahedra().mesh));
}
