#include "clouds.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <vector>

#include "coppice/spatial/box_tree.h"

namespace coppice::cli {
namespace {

constexpr std::size_t kSpacingSample = 2000;
constexpr std::size_t kMostDrawn = 500'000;

double distance_to_nearest_other(const BoxTree& tree, const Buffer<Vec3>& points, std::size_t i) {
    double nearest = std::numeric_limits<double>::infinity();
    const auto bound = [&](std::uint32_t level, std::uint32_t box) {
        return std::sqrt(distance_squared(tree.level(level)[box], Vec3d(points[i])));
    };
    tree.search(bound, nearest, [&](std::uint32_t item) {
        if (item == i) return;
        nearest = std::min(nearest, distance(Vec3d(points[item]), Vec3d(points[i])));
        if (nearest == 0) nearest = -1;  // ends the search: many more may lie in the same place
    });
    return std::max(nearest, 0.0);
}

}  // namespace

double median_spacing(const PointSet& points, const Context& ctx) {
    if (points.size() < 2) return 0;
    std::vector<Box3> boxes(points.size());
    for (std::size_t i = 0; i < points.size(); ++i) boxes[i].extend(points.positions[i]);
    const BoxTree tree(boxes, ctx);
    const std::size_t sample = std::min(points.size(), kSpacingSample);
    std::vector<double> distances;
    for (std::size_t k = 0; k < sample; ++k)
        distances.push_back(distance_to_nearest_other(tree, points.positions, k * points.size() / sample));
    const auto middle = distances.begin() + static_cast<std::ptrdiff_t>(sample / 2);
    std::ranges::nth_element(distances, middle);
    return *middle;
}

PolygonMesh drawn_points(const PointSet& points, double radius) {
    constexpr std::array<Triangle, 8> kFaces{
        {{0, 2, 4}, {2, 1, 4}, {1, 3, 4}, {3, 0, 4}, {2, 0, 5}, {1, 2, 5}, {3, 1, 5}, {0, 3, 5}}};
    const float r = static_cast<float>(radius);
    const std::array<Vec3, 6> corners{{{r, 0, 0}, {-r, 0, 0}, {0, r, 0}, {0, -r, 0}, {0, 0, r}, {0, 0, -r}}};
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

}  // namespace coppice::cli
