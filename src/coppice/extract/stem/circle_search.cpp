#include "coppice/extract/stem/circle_search_internal.h"

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <cstddef>
#include <limits>
#include <numbers>

#include "coppice/base/kernel/fast_atan2.h"
#include "coppice/base/random.h"

namespace coppice::extract_internal {
namespace {

constexpr std::uint64_t kDrawStage = 0x63697263;
constexpr int kSectors = 36;
constexpr std::size_t kMin = 8;          // minimum number of points of a circle
constexpr std::size_t kMaxScored = 400;  // maximum number of points for the score of a draw
constexpr int kMinDraws = 150, kMaxDraws = 900;
constexpr double kMinCoverage = 0.22;

struct Circle {
    double x, y, r;
};

/// Returns the circle through three points; radius 0 if they are collinear.
Circle through(const PlanePoint& a, const PlanePoint& b, const PlanePoint& c) {
    const double bx = b.x - a.x, by = b.y - a.y, cx = c.x - a.x, cy = c.y - a.y;
    const double d = 2 * (bx * cy - by * cx);
    if (std::abs(d) < 1e-12) return {0, 0, 0};
    const double bb = bx * bx + by * by, cc = cx * cx + cy * cy;
    const double ux = (cy * bb - by * cc) / d, uy = (bx * cc - cx * bb) / d;
    return {a.x + ux, a.y + uy, std::hypot(ux, uy)};
}

std::size_t compute_sector(double dx, double dy) {
    const float turn = fast_atan2(static_cast<float>(dy), static_cast<float>(dx));
    const double share = double{turn} / (2 * std::numbers::pi) + 0.5;
    return static_cast<std::size_t>(std::clamp(share * kSectors, 0.0, kSectors - 1.0));
}

/// Returns the maximum distance from a circle of this radius of points that are on it.
double compute_tolerance(double radius, double noise) {
    return std::min(2 * noise + 0.03 * radius, 0.25 * radius);
}

/// Returns the share of sectors with points on the circle, reduced by a penalty for points inside.
double score(std::span<const PlanePoint> points, std::size_t stride, const Circle& c, double noise) {
    const double tolerance = compute_tolerance(c.r, noise);
    const double low = c.r - tolerance, high = c.r + tolerance, deep = std::max(c.r - 2.5 * tolerance, 0.0);
    std::uint64_t seen = 0;
    double on = 0, in = 0;
    for (std::size_t i = 0; i < points.size(); i += stride) {
        const double dx = points[i].x - c.x, dy = points[i].y - c.y, dd = dx * dx + dy * dy;
        if (dd > high * high) continue;
        if (dd < deep * deep) in += 1;
        if (dd < low * low) continue;
        on += 1;
        seen |= std::uint64_t{1} << compute_sector(dx, dy);
    }
    if (on < 4) return 0;
    return static_cast<double>(std::popcount(seen)) / kSectors * (on / (on + 3 * in));
}

/// Computes residual, deviation, coverage and the number of points inside. The number of points per sector is
/// limited for the information, because adjacent points have correlated errors of the bark.
void judge(std::span<const PlanePoint> points, double noise, FoundCircle& c) {
    const double tolerance = compute_tolerance(c.radius, std::max(noise, c.residual));
    const double deep = std::max(c.radius - 2.5 * tolerance, 0.0);
    struct Sector {
        double count = 0, off = 0, squares = 0;
    };
    std::array<Sector, kSectors> sectors{};
    double inside = 0, squares = 0;
    c.used = 0;
    for (const PlanePoint& p : points) {
        const double dx = p.x - c.x, dy = p.y - c.y, d = std::hypot(dx, dy), off = d - c.radius;
        if (d < deep) ++inside;
        if (std::abs(off) > tolerance) continue;
        Sector& sector = sectors[compute_sector(dx, dy)];
        sector.count += 1;
        sector.off += off;
        squares += off * off;
        ++c.used;
    }
    if (c.used == 0) return;
    c.residual = std::sqrt(squares / c.used);
    c.inside = inside / c.used;
    // Information on (x, y, r): each sector counts as four points at most.
    double xx = 0, xy = 0, xr = 0, yy = 0, yr = 0, rr = 0;
    int filled = 0;
    for (int s = 0; s < kSectors; ++s) {
        const double w = std::min(sectors[static_cast<std::size_t>(s)].count, 4.0);
        if (w == 0) continue;
        ++filled;
        const double angle = 2 * std::numbers::pi * ((s + 0.5) / kSectors - 0.5);
        const double ux = std::cos(angle), uy = std::sin(angle);
        xx += w * ux * ux, xy += w * ux * uy, xr += w * ux;
        yy += w * uy * uy, yr += w * uy, rr += w;
    }
    c.coverage = static_cast<double>(filled) / kSectors;
    const double minor = xx * yy - xy * xy;
    const double det = minor * rr - xx * yr * yr - yy * xr * xr + 2 * xy * xr * yr;
    c.deviation = det > 1e-9 * rr * rr * rr ? c.residual * std::sqrt(minor / det) : c.radius;
}

std::vector<PlanePoint> near_circle(std::span<const PlanePoint> points, const Circle& c, double tolerance) {
    std::vector<PlanePoint> near;
    for (const PlanePoint& p : points) {
        if (std::abs(std::hypot(p.x - c.x, p.y - c.y) - c.r) < tolerance) near.push_back(p);
    }
    return near;
}

/// Returns the best of the circles through three random points each; radius 0 if no circle is acceptable.
Circle draw_circles(std::span<const PlanePoint> points, const CircleSearch& search) {
    const CounterRandom random(search.seed, kDrawStage);
    const auto n = points.size();
    const std::size_t stride = (n + kMaxScored - 1) / kMaxScored;
    const int draws = std::clamp(static_cast<int>(n / 2), kMinDraws, kMaxDraws);
    const double reach = 2 * search.max_radius;
    std::uint64_t next = 0;
    const auto draw = [&](std::size_t low, std::size_t high) {
        const double t = random.uniform(next++);
        return std::min(low + static_cast<std::size_t>(t * static_cast<double>(high - low)), high - 1);
    };
    Circle best{0, 0, 0};
    double most = 0;
    for (int k = 0; k < draws; ++k) {
        // The other two points are drawn within reach of the first one in x; the points are sorted by x.
        const std::size_t a = draw(0, n);
        const auto left = std::ranges::lower_bound(points, points[a].x - reach, {}, &PlanePoint::x);
        const auto right = std::ranges::upper_bound(points, points[a].x + reach, {}, &PlanePoint::x);
        const auto low = static_cast<std::size_t>(left - points.begin());
        const auto high = static_cast<std::size_t>(right - points.begin());
        const std::size_t b = draw(low, high), c = draw(low, high);
        if (a == b || b == c || a == c) continue;
        const Circle circle = through(points[a], points[b], points[c]);
        if (circle.r < search.min_radius || circle.r > search.max_radius) continue;
        if (!search.anywhere && std::hypot(circle.x - search.x, circle.y - search.y) > search.reach) continue;
        const double value = score(points, stride, circle, search.noise);
        if (value <= most) continue;
        most = value;
        best = circle;
    }
    return best;
}

}  // namespace

FoundCircle find_circle(std::span<const PlanePoint> points, const CircleSearch& search) {
    FoundCircle out;
    if (points.size() < kMin) return out;
    std::vector<PlanePoint> sorted(points.begin(), points.end());
    std::ranges::sort(
        sorted, [](const PlanePoint& a, const PlanePoint& b) { return a.x != b.x ? a.x < b.x : a.y < b.y; });
    Circle best = draw_circles(sorted, search);
    if (!(best.r > 0)) return out;
    for (int pass = 0; pass < 3; ++pass) {
        const double tolerance = (pass == 0 ? 2.0 : 1.5) * compute_tolerance(best.r, search.noise);
        const auto near = near_circle(sorted, best, tolerance);
        const CircleFit fit = fit_circle(near, 1.25 * search.max_radius);
        if (fit.used < kMin || !(fit.radius > 0) || std::abs(fit.radius - best.r) > 0.5 * best.r) break;
        best = {fit.x, fit.y, fit.radius};
        out.residual = fit.residual;
    }
    if (best.r < search.min_radius || best.r > search.max_radius) return out;
    out.x = best.x, out.y = best.y, out.radius = best.r;
    judge(sorted, search.noise, out);
    if (out.used < kMin || out.coverage < kMinCoverage) out.used = 0;
    return out;
}

double outline_radius(std::span<const PlanePoint> points, const FoundCircle& circle, double noise) {
    constexpr double kNearest = 0.2, kMinFilled = 0.8;
    std::array<std::vector<double>, kSectors> sectors;
    for (const PlanePoint& p : points) {
        const double dx = p.x - circle.x, dy = p.y - circle.y, d = std::hypot(dx, dy);
        if (d > 0.5 * circle.radius && d < 1.6 * circle.radius) sectors[compute_sector(dx, dy)].push_back(d);
    }
    const double thick = 3 * compute_tolerance(circle.radius, noise);
    double squares = 0, filled = 0;
    for (auto& distances : sectors) {
        if (distances.empty()) continue;
        std::ranges::sort(distances);
        const double first =
            distances[static_cast<std::size_t>(kNearest * static_cast<double>(distances.size()))];
        const auto last = std::ranges::upper_bound(distances, first + thick);
        const double middle = distances[static_cast<std::size_t>(last - distances.begin() - 1) / 2];
        squares += middle * middle;
        filled += 1;
    }
    return filled >= kMinFilled * kSectors ? std::sqrt(squares / filled) : circle.radius;
}

double circle_contrast(std::span<const PlanePoint> points, const FoundCircle& circle, double noise,
                       double reach) {
    struct Region {
        double area, filled = 0;  // [squares]
        double share() const { return filled / area; }
        /// Returns the log-likelihood of the filled squares if a share p of all squares is filled.
        double log_likelihood(double p) const {
            const double empty = area - filled;
            return (filled > 0 ? filled * std::log(p) : 0) + (empty > 0 ? empty * std::log1p(-p) : 0);
        }
    };
    const double tolerance = compute_tolerance(circle.radius, noise), edge = 2 * tolerance;
    const double low = circle.radius - tolerance, high = circle.radius + tolerance;
    const auto disc = [&](double r) { return std::numbers::pi * r * r / (edge * edge); };
    Region inside{disc(low)}, on{disc(high) - disc(low)}, outside{std::max(disc(reach) - disc(high), 1.0)};
    for (const PlanePoint& p : thin_plane(points, edge)) {
        const double d = std::hypot(p.x - circle.x, p.y - circle.y);
        (d < low ? inside : d > high ? outside : on).filled += 1;
    }
    Region all{0};
    for (Region* region : {&inside, &on, &outside}) {
        region->area = std::max(region->area, region->filled);
        all.area += region->area;
        all.filled += region->filled;
    }
    if (!(on.share() > std::max(inside.share(), outside.share()))) return 0;
    double gain = 0;
    for (const Region& region : {inside, on, outside})
        gain += region.log_likelihood(region.share()) - region.log_likelihood(all.share());
    return gain;
}

std::vector<PlanePoint> thin_plane(std::span<const PlanePoint> points, double edge) {
    struct Place {
        std::int64_t i, j;
        std::uint32_t index;
        auto operator<=>(const Place&) const = default;
    };
    std::vector<Place> places;
    places.reserve(points.size());
    for (std::uint32_t k = 0; k < points.size(); ++k) {
        places.push_back({static_cast<std::int64_t>(std::floor(points[k].x / edge)),
                          static_cast<std::int64_t>(std::floor(points[k].y / edge)), k});
    }
    std::ranges::sort(places);
    std::vector<PlanePoint> kept;
    for (std::size_t k = 0; k < places.size(); ++k) {
        if (k > 0 && places[k].i == places[k - 1].i && places[k].j == places[k - 1].j) continue;
        kept.push_back(points[places[k].index]);
    }
    return kept;
}

}  // namespace coppice::extract_internal
