#include "coppice/extract/tree/circle_fit_internal.h"

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <numbers>
#include <vector>

#include "coppice/base/median.h"

namespace coppice::extract_internal {
namespace {

constexpr std::size_t kMin = 6;
constexpr int kSteps = 8;
constexpr int kSectors = 12;
constexpr int kMinSectors = 4;  // number of sectors about the centre; minimum number of them with points

/// Replaces `std::hypot`: its protection from overflow used an eighth of the time of an extraction.
double norm(double x, double y) { return std::sqrt(x * x + y * y); }

struct Circle {
    double x, y, r;
};

/// Applies Newton's method to the characteristic polynomial of Taubin's generalised eigenvalue problem.
bool taubin(std::span<const PlanePoint> points, Circle& out) {
    double sum = 0, mx = 0, my = 0;
    for (const PlanePoint& p : points) {
        sum += p.weight;
        mx += p.weight * p.x;
        my += p.weight * p.y;
    }
    if (!(sum > 0)) return false;
    mx /= sum;
    my /= sum;
    double xx = 0, yy = 0, xy = 0, xz = 0, yz = 0, zz = 0;
    for (const PlanePoint& p : points) {
        const double x = p.x - mx, y = p.y - my, z = x * x + y * y, w = p.weight / sum;
        xx += w * x * x;
        yy += w * y * y;
        xy += w * x * y;
        xz += w * x * z;
        yz += w * y * z;
        zz += w * z * z;
    }
    const double mz = xx + yy, cov = xx * yy - xy * xy, var = zz - mz * mz;
    const double a3 = 4 * mz, a2 = -3 * mz * mz - zz, a1 = var * mz + 4 * cov * mz - xz * xz - yz * yz;
    const double a0 = xz * (xz * yy - yz * xy) + yz * (yz * xx - xz * xy) - var * cov;
    double t = 0, value = a0;
    for (int step = 0; step < 30; ++step) {
        const double slope = a1 + t * (2 * a2 + t * 3 * a3);
        if (slope == 0) break;
        const double next = t - value / slope;
        if (!std::isfinite(next) || next == t) break;
        const double at = a0 + next * (a1 + next * (a2 + next * a3));
        if (std::abs(at) >= std::abs(value)) break;
        t = next;
        value = at;
    }
    const double det = t * t - t * mz + cov;
    if (!(std::abs(det) > 1e-12 * mz * mz)) return false;
    const double x = (xz * (yy - t) - yz * xy) / det / 2, y = (yz * (xx - t) - xz * xy) / det / 2;
    out = {x + mx, y + my, std::sqrt(x * x + y * y + mz)};
    return std::isfinite(out.r);
}

/// Performs one Gauss-Newton step with Tukey's weights at `scale`, where `distance` is the distance of each
/// point from the centre; returns false if the points do not determine a circle.
bool improve(std::span<const PlanePoint> points, std::span<const double> distance, double scale, Circle& c) {
    std::array<double, 6> a{};  // xx xy xr yy yr rr
    std::array<double, 3> b{};
    for (std::size_t i = 0; i < points.size(); ++i) {
        const PlanePoint& p = points[i];
        const double dx = p.x - c.x, dy = p.y - c.y, d = distance[i];
        const double off = d - c.r, t = off / scale;
        if (!(d > 0) || std::abs(t) >= 1) continue;
        const double w = p.weight * (1 - t * t) * (1 - t * t), ux = dx / d, uy = dy / d;
        a[0] += w * ux * ux;
        a[1] += w * ux * uy;
        a[2] += w * ux;
        a[3] += w * uy * uy;
        a[4] += w * uy;
        a[5] += w;
        b[0] += w * ux * off;
        b[1] += w * uy * off;
        b[2] += w * off;
    }
    // A weak regularization towards the current position keeps the circle stable if an arc is short.
    for (const int i : {0, 3}) a[static_cast<std::size_t>(i)] += 1e-3 * a[5];
    const double c0 = a[3] * a[5] - a[4] * a[4], c1 = a[2] * a[4] - a[1] * a[5],
                 c2 = a[1] * a[4] - a[2] * a[3];
    const double det = a[0] * c0 + a[1] * c1 + a[2] * c2;
    if (!(det > 1e-9 * a[5] * a[5] * a[5])) return false;
    const double c4 = a[0] * a[5] - a[2] * a[2], c5 = a[1] * a[2] - a[0] * a[4],
                 c8 = a[0] * a[3] - a[1] * a[1];
    const double limit = 0.5 * c.r;
    c.x += std::clamp((c0 * b[0] + c1 * b[1] + c2 * b[2]) / det, -limit, limit);
    c.y += std::clamp((c1 * b[0] + c4 * b[1] + c5 * b[2]) / det, -limit, limit);
    c.r += std::clamp((c2 * b[0] + c5 * b[1] + c8 * b[2]) / det, -limit, limit);
    return std::isfinite(c.x) && std::isfinite(c.y) && c.r > 0;
}

/// Returns 4.685 standard deviations of the distances from a circle, estimated from the median; with a lower
/// bound above the rounding error.
double compute_scale(std::span<const double> distance, const Circle& c, std::vector<double>& scratch) {
    scratch.resize(distance.size());
    for (std::size_t i = 0; i < distance.size(); ++i) scratch[i] = std::abs(distance[i] - c.r);
    return std::max(4.685 * 1.4826 * median_in_place(scratch), 0.02 * c.r);
}

/// Returns whether points near a circle are in enough sectors about its centre.
bool fills_sectors(std::span<const PlanePoint> points, const Circle& c, double scale) {
    unsigned seen = 0;
    for (const PlanePoint& p : points) {
        const double dx = p.x - c.x, dy = p.y - c.y;
        if (std::abs(norm(dx, dy) - c.r) >= scale) continue;
        const double turn = (std::atan2(dy, dx) / (2 * std::numbers::pi) + 0.5) * kSectors;
        seen |= 1u << static_cast<unsigned>(std::clamp(turn, 0.0, kSectors - 1.0));
        if (std::popcount(seen) >= kMinSectors) return true;
    }
    return false;
}

}  // namespace

CircleFit fit_circle(std::span<const PlanePoint> points, double max_radius) {
    CircleFit fit;
    Circle c{};
    if (points.size() < kMin || !taubin(points, c)) return fit;
    std::vector<double> distance(points.size()), scratch;
    double scale = 0;
    for (int step = 0; step < kSteps; ++step) {
        for (std::size_t i = 0; i < points.size(); ++i)
            distance[i] = norm(points[i].x - c.x, points[i].y - c.y);
        scale = compute_scale(distance, c, scratch);
        if (!improve(points, distance, scale, c)) return fit;
    }
    double squares = 0, weights = 0;
    for (const PlanePoint& p : points) {
        const double off = norm(p.x - c.x, p.y - c.y) - c.r;
        if (std::abs(off) >= scale) continue;
        ++fit.used;
        squares += p.weight * off * off;
        weights += p.weight;
    }
    fit.x = c.x;
    fit.y = c.y;
    fit.radius = c.r;
    fit.residual = weights > 0 ? std::sqrt(squares / weights) : 0;
    fit.good = fit.used >= kMin && 2 * fit.used >= points.size() && c.r <= max_radius &&
               fit.residual <= 0.35 * c.r && fills_sectors(points, c, scale);
    return fit;
}

}  // namespace coppice::extract_internal
