#include "coppice/mesh/normals.h"

namespace coppice {
namespace {

Vec3 area_normal(std::span<const Vec3> p, const Triangle& t) {
    return cross(p[t[1]] - p[t[0]], p[t[2]] - p[t[0]]);
}

template <class Face>
Buffer<Vec3> compute_normals(std::span<const Vec3> positions, std::span<const Face> faces) {
    Buffer<Vec3> out;
    out.assign(positions.size(), Vec3{});
    for (const Face& face : faces) {
        const Vec3 n = area_normal(positions, face);
        for (const std::uint32_t v : face) out[v] += n;
    }
    for (Vec3& n : out) n = normalized(n);
    return out;
}

}  // namespace

Buffer<Vec3> smooth_normals(std::span<const Vec3> positions, std::span<const Quad> quads) {
    return compute_normals(positions, quads);
}

Buffer<Vec3> smooth_normals(const TriMesh& mesh) {
    return compute_normals<Triangle>(mesh.positions, mesh.triangles);
}

}  // namespace coppice
