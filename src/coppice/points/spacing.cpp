#include "coppice/points/spacing.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <vector>

#include "coppice/spatial/box_tree.h"

namespace coppice {
namespace {

constexpr std::size_t kSpacingSample = 2000;
constexpr double kMaxElongated = 50;

double distance_to_nearest_other(const BoxTree& tree, const Buffer<Vec3>& points, std::size_t i) {
    double nearest = std::numeric_limits<double>::infinity();
    const auto bound = [&](std::uint32_t level, std::uint32_t box) {
        return std::sqrt(distance_squared(tree.level(level)[box], Vec3d(points[i])));
    };
    tree.search(bound, nearest, [&](std::uint32_t item) {
        if (item == i) return;
        nearest = std::min(nearest, distance(Vec3d(points[item]), Vec3d(points[i])));
        if (nearest == 0) nearest = -1;  // ends the search: many more points may coincide
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

std::optional<std::string> warning_of_extent(const PointSet& points) {
    const Vec3 size = bounds(points).size();
    const int axis = size.x >= size.y && size.x >= size.z ? 0 : size.y >= size.z ? 1 : 2;
    const char name = "xyz"[axis];
    const double others = std::max(double{size[(axis + 1) % 3]}, double{size[(axis + 2) % 3]});
    if (points.size() < 3 || double{size[axis]} <= kMaxElongated * others) return {};
    return fmt::format(
        "the points extend {:.4g} m along {} but {:.4g} m at most along the other axes; is {} the right "
        "column?",
        size[axis], name, others, name);
}

}  // namespace coppice
