#include "coppice/extract/mesh/ring_measure_internal.h"

#include <algorithm>
#include <cmath>

namespace coppice::extract_internal {
namespace {

struct Circle {
    Vec3d center;
    double radius = 0;
};

/// Returns the circle of least algebraic distance from the points, projected onto the plane through `middle`
/// normal to `axis` [Kasa1976]; radius 0 if they are collinear.
Circle fit_circle(std::span<const Vec3d> points, Vec3d middle, Vec3d axis) {
    const Vec3d e = perpendicular(axis), g = cross(axis, e);
    double xx = 0, xy = 0, yy = 0, xz = 0, yz = 0, zz = 0, sx = 0, sy = 0;
    const auto n = static_cast<double>(points.size());
    for (const Vec3d p : points) {
        sx += dot(p - middle, e) / n;
        sy += dot(p - middle, g) / n;
    }
    for (const Vec3d p : points) {
        const double x = dot(p - middle, e) - sx, y = dot(p - middle, g) - sy, z = x * x + y * y;
        xx += x * x, xy += x * y, yy += y * y, xz += x * z, yz += y * z, zz += z;
    }
    const double det = xx * yy - xy * xy;
    if (!(det > 1e-6 * zz * zz)) return {};
    const double a = 0.5 * (xz * yy - yz * xy) / det, b = 0.5 * (yz * xx - xz * xy) / det;
    return {middle + e * (a + sx) + g * (b + sy), std::sqrt(zz / n + a * a + b * b)};
}

}  // namespace

Ring measure_ring(std::span<const Vec3d> points, bool closed) {
    const std::size_t n = points.size(), edges = closed ? n : n - 1;
    double total = 0;
    Vec3d sum, area;
    for (std::size_t i = 0; i < edges; ++i) {
        const Vec3d a = points[i], b = points[(i + 1) % n];
        sum += (a + b) * (0.5 * distance(a, b));
        total += distance(a, b);
    }
    Ring ring;
    ring.center = total > 0 ? sum / total : points[0];
    for (std::size_t i = 0; i < n; ++i)
        area += cross(points[i] - ring.center, points[(i + 1) % n] - ring.center);
    const Vec3d axis = normalized(area, {});
    if (!closed) {
        const Circle circle = fit_circle(points, ring.center, axis);
        // A nearly straight arc does not determine its circle.
        if (circle.radius > 0 && circle.radius < total) ring.center = circle.center;
    }
    double r = 0, r2 = 0;
    for (std::size_t i = 0; i < edges; ++i) {
        const Vec3d a = points[i], b = points[(i + 1) % n], m = (a + b) * 0.5 - ring.center;
        const double along = dot(m, axis), d2 = std::max(0.0, length_squared(m) - along * along);
        r += distance(a, b) * std::sqrt(d2);
        r2 += distance(a, b) * d2;
    }
    if (!(r > 0)) return ring;
    ring.radius = r / total;
    ring.spread = std::sqrt(std::max(0.0, r2 / total - ring.radius * ring.radius)) / ring.radius;
    return ring;
}

}  // namespace coppice::extract_internal
