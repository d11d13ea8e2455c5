#include "coppice/foliage/crown_area_internal.h"

#include <algorithm>
#include <utility>

namespace coppice::foliage_internal {
namespace {

/// Returns twice the signed area of a triangle.
double turn(Point2 a, Point2 b, Point2 c) {
    return (double{b.x} - double{a.x}) * (double{c.y} - double{a.y}) -
           (double{b.y} - double{a.y}) * (double{c.x} - double{a.x});
}

}  // namespace

void keep_hull(std::vector<Point2>& points) {
    std::ranges::sort(points, [](Point2 a, Point2 b) { return std::pair(a.x, a.y) < std::pair(b.x, b.y); });
    std::vector<Point2> hull;
    const auto add = [&](Point2 p, std::size_t least) {
        while (hull.size() > least && turn(hull[hull.size() - 2], hull.back(), p) <= 0) hull.pop_back();
        hull.push_back(p);
    };
    for (const Point2 p : points) add(p, 1);
    const std::size_t lower = hull.size();
    for (std::size_t i = points.size(); i-- > 0;) add(points[i], lower);
    if (hull.size() > 1) hull.pop_back();
    points = std::move(hull);
}

double compute_area(const std::vector<Point2>& corners) {
    double sum = 0;
    for (std::size_t i = 1; i + 1 < corners.size(); ++i) sum += turn(corners[0], corners[i], corners[i + 1]);
    return 0.5 * sum;
}

}  // namespace coppice::foliage_internal
