#include "coppice/implicit/shape/profile.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numbers>

#include "coppice/base/error.h"
#include "coppice/implicit/solid/input_internal.h"

namespace coppice {
namespace {

constexpr double kTolerance = 1e-4;  // [size of the contour] maximum deviation
constexpr int kMaxChords = 64;       // maximum number per arc

/// Converts the curve to a polygon.
std::vector<Vec2d> flattened(const Curve& curve) {
    const double tolerance = kTolerance * curve.bounds().diagonal();
    std::vector<Vec2d> corners;
    const auto add = [&](Vec3d p) {
        if (corners.empty() || corners.back() != Vec2d{p.x, p.y}) corners.push_back({p.x, p.y});
    };
    for (const CurveArc& arc : curve.arcs()) {
        const int n =
            std::clamp(static_cast<int>(std::ceil(std::sqrt(arc.slack / tolerance))), 1, kMaxChords);
        for (int i = 0; i < n; ++i) add(arc.position(static_cast<double>(i) / n));
    }
    if (!curve.closed()) add(curve.arcs().back().position(1));
    return corners;
}

}  // namespace

Profile::Profile(std::span<const Vec2d> points, CurveKind kind, bool closed) : closed_(closed) {
    add(points, kind);
    finish();
}

Profile::Profile(std::span<const std::vector<Vec2d>> contours, CurveKind kind) : closed_(true) {
    if (contours.empty()) throw InvalidInput("profile: there is no contour; specify at least one");
    for (const std::vector<Vec2d>& c : contours) add(c, kind);
    finish();
}

void Profile::add(std::span<const Vec2d> points, CurveKind kind) {
    std::vector<Vec3> in_space(points.size());
    for (std::size_t i = 0; i < points.size(); ++i) {
        check_coordinate(points[i].x, "profile", "point", i);
        check_coordinate(points[i].y, "profile", "point", i);
        in_space[i] = {static_cast<float>(points[i].x), static_cast<float>(points[i].y), 0};
    }
    const Curve curve(in_space, {.kind = kind, .closed = closed_});
    std::vector<Vec2d> corners =
        kind == CurveKind::polyline ? std::vector(points.begin(), points.end()) : flattened(curve);
    const float size = curve.bounds().diagonal();
    if (closed_ && !(std::abs(contour_area(corners)) > kMinContourArea * size * size))
        throw InvalidInput(
            fmt::format("profile: contour {} encloses no area; its points must not be on one line",
                        contours_.size() + 1));
    contours_.push_back(std::move(corners));
}

void Profile::finish() {
    std::vector<PlaneSegment> segments;
    for (const std::vector<Vec2d>& c : contours_)
        for (std::size_t i = 0; i + 1 < c.size() + (closed_ ? 1 : 0); ++i)
            segments.push_back({c[i], c[(i + 1) % c.size()]});
    index_ = ContourIndex(std::move(segments), closed_);
}

double Profile::reach() const {
    double most = 0;
    for (const std::vector<Vec2d>& c : contours_)
        for (const Vec2d p : c) most = std::max(most, std::hypot(p.x, p.y));
    return most;
}

void Profile::distance(std::span<const Vec2d> points, std::span<PlaneSample> out) const {
    for (std::size_t i = 0; i < points.size(); ++i) out[i] = index_.distance(points[i]);
}

std::vector<Vec2d> circle_contour(Vec2d center, double radius, int corners) {
    if (!(radius > 0 && radius <= kFarthest) || corners < 3 || corners > 4096)
        throw InvalidInput(
            fmt::format("profile: a circle needs a radius above 0 and 3 to 4096 corners, but has {} and {}",
                        radius, corners));
    std::vector<Vec2d> contour;
    for (int i = 0; i < corners; ++i) {
        const double angle = 2 * std::numbers::pi * i / corners;
        contour.push_back(center + Vec2d{std::cos(angle), std::sin(angle)} * radius);
    }
    return contour;
}

}  // namespace coppice
