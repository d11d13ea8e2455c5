#include "coppice/render/cloud_mesh.h"

#include <algorithm>
#include <array>

namespace coppice {

PolygonMesh mesh_of_cloud(const PointSet& points, double radius) {
    constexpr std::array<Triangle, 8> kFaces{
        {{0, 2, 4}, {2, 1, 4}, {1, 3, 4}, {3, 0, 4}, {2, 0, 5}, {1, 2, 5}, {3, 1, 5}, {0, 3, 5}}};
    const float r = static_cast<float>(radius);
    const std::array<Vec3, 6> corners{{{r, 0, 0}, {-r, 0, 0}, {0, r, 0}, {0, -r, 0}, {0, 0, r}, {0, 0, -r}}};
    constexpr std::size_t kMostDrawn = 500'000;
    PolygonMesh mesh;
    mesh.origin = points.origin;
    const std::size_t count = std::min(points.size(), kMostDrawn);
    mesh.positions.reserve(count * corners.size());
    for (std::size_t k = 0; k < count; ++k) {
        const auto base = static_cast<std::uint32_t>(mesh.positions.size());
        const Vec3 p = points.positions[k * points.size() / count];
        for (const Vec3 corner : corners) mesh.positions.push_back(p + corner);
        for (const Triangle& face : kFaces)
            mesh.add_face(std::array{base + face[0], base + face[1], base + face[2]});
    }
    return mesh;
}

}  // namespace coppice
