#include "coppice/spatial/planar_hull.h"

#include <algorithm>
#include <cstddef>

namespace coppice {

std::vector<Vec3d> compute_planar_hull(std::vector<Vec3d> points) {
    std::ranges::sort(points, [](Vec3d a, Vec3d b) { return a.x != b.x ? a.x < b.x : a.y < b.y; });
    if (points.size() < 2) return points;
    std::vector<Vec3d> hull;
    const auto add = [&](Vec3d p, std::size_t first) {
        while (hull.size() >= first + 2 && turn_in_plan(hull[hull.size() - 2], hull.back(), p) <= 0)
            hull.pop_back();
        hull.push_back(p);
    };
    for (const Vec3d p : points) add(p, 0);
    const std::size_t lower = hull.size() - 1;
    for (std::size_t i = points.size() - 1; i-- > 0;) add(points[i], lower);
    hull.pop_back();  // same as the first one
    return hull;
}

double compute_planar_area(std::span<const Vec3d> corners) {
    double twice = 0;
    for (std::size_t i = 1; i + 1 < corners.size(); ++i)
        twice += turn_in_plan(corners[0], corners[i], corners[i + 1]);
    return 0.5 * twice;
}

}  // namespace coppice
