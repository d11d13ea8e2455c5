#include "coppice/mesh/mesh.h"

namespace coppice {
namespace {

void add_quad(TriMesh& out, std::uint32_t a, std::uint32_t b, std::uint32_t c, std::uint32_t d) {
    const auto& x = out.positions;
    if (length_squared(x[a] - x[c]) <= length_squared(x[b] - x[d])) {
        out.triangles.push_back({a, b, c});
        out.triangles.push_back({a, c, d});
    } else {
        out.triangles.push_back({b, c, d});
        out.triangles.push_back({b, d, a});
    }
}

template <class Mesh, class Face>
PolygonMesh as_polygons(const Mesh& mesh, const Buffer<Face>& faces) {
    PolygonMesh out;
    out.positions = mesh.positions;
    out.origin = mesh.origin;
    out.corners.reserve(std::tuple_size_v<Face> * faces.size());
    out.first.reserve(faces.size() + 1);
    for (const Face& f : faces) out.add_face(f);
    return out;
}

}  // namespace

PolygonMesh to_polygons(const QuadMesh& mesh) { return as_polygons(mesh, mesh.quads); }
PolygonMesh to_polygons(const TriMesh& mesh) { return as_polygons(mesh, mesh.triangles); }

TriMesh triangulate(const QuadMesh& mesh) {
    TriMesh out{mesh.positions, {}, mesh.origin};
    out.triangles.reserve(2 * mesh.quads.size());
    for (const Quad& q : mesh.quads) add_quad(out, q[0], q[1], q[2], q[3]);
    return out;
}

TriMesh triangulate(const PolygonMesh& mesh) {
    TriMesh out{mesh.positions, {}, mesh.origin};
    for (std::uint32_t f = 0; f < mesh.face_count(); ++f) {
        const auto c = mesh.face(f);
        if (c.size() == 4) {
            add_quad(out, c[0], c[1], c[2], c[3]);
        } else {
            for (std::size_t k = 1; k + 1 < c.size(); ++k) out.triangles.push_back({c[0], c[k], c[k + 1]});
        }
    }
    return out;
}

}  // namespace coppice
