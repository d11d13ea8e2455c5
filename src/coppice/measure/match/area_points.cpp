#include "coppice/measure/match/area_points_internal.h"

#include <algorithm>
#include <cmath>
#include <iterator>

#include "coppice/mesh/shape.h"

namespace coppice::measure_internal {

AreaPoints::AreaPoints(const PolygonMesh& mesh, std::size_t count) : mesh_(mesh), count_(count) {
    after_.reserve(mesh.face_count());
    double sum = 0;
    for (std::uint32_t f = 0; f < mesh.face_count(); ++f) {
        for_each_triangle(mesh.face(f), mesh.positions, [&](const Triangle& t) { sum += area(t); });
        after_.push_back(sum);
    }
    if (!(sum > 0) || !std::isfinite(sum)) count_ = 0;
}

Vec3d AreaPoints::operator[](std::size_t i) const {
    const double at = (static_cast<double>(i) + 0.5) / static_cast<double>(count_) * after_.back();
    const auto face = std::upper_bound(after_.begin(), std::prev(after_.end()), at) - after_.begin();
    double rest = at - (face > 0 ? after_[static_cast<std::size_t>(face) - 1] : 0);
    Vec3d point;
    bool found = false;
    const auto f = static_cast<std::uint32_t>(face);
    for_each_triangle(mesh_.face(f), mesh_.positions, [&](const Triangle& t) {
        const double a = area(t);
        if (found || !(a > 0)) return;
        found = rest <= a;
        point = spread(t, i);
        rest -= a;
    });
    return point;
}

double AreaPoints::area(const Triangle& t) const {
    const Vec3d a(mesh_.positions[t[0]]), b(mesh_.positions[t[1]]), c(mesh_.positions[t[2]]);
    return length(cross(b - a, c - a)) / 2;
}

/// Returns a point of a triangle; the points of consecutive numbers fill a triangle evenly.
Vec3d AreaPoints::spread(const Triangle& t, std::size_t i) const {
    constexpr double kPlastic = 1.324717957244746;  // x^3 = x + 1
    const auto part = [&](double step) {
        const double x = 0.5 + static_cast<double>(i) * step;
        return x - std::floor(x);
    };
    double u = part(1 / kPlastic), v = part(1 / (kPlastic * kPlastic));
    if (u + v > 1) {
        u = 1 - u;
        v = 1 - v;
    }
    const Vec3d a(mesh_.positions[t[0]]), b(mesh_.positions[t[1]]), c(mesh_.positions[t[2]]);
    return a + (b - a) * u + (c - a) * v;
}

}  // namespace coppice::measure_internal
