#include "coppice/implicit/shape/revolution.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "coppice/base/error.h"
#include "coppice/implicit/solid/input_internal.h"

namespace coppice {
namespace {

/// Combines an open profile and its mirror image to a closed contour: for points right of the axis, the
/// segments right of it are nearest.
std::vector<Vec2d> mirrored(std::span<const Vec2d> line) {
    std::vector<Vec2d> corners;
    const auto add = [&](Vec2d p) {
        if (corners.empty() || corners.back() != p) corners.push_back(p);
    };
    for (const Vec2d p : line) add(p);
    for (std::size_t i = line.size(); i-- > 0;) add({-line[i].x, line[i].y});
    while (corners.size() > 1 && corners.front() == corners.back()) corners.pop_back();
    return corners;
}

}  // namespace

Revolution::Revolution(const Profile& profile, const Axis& axis)
    : origin_(axis.origin), direction_(axis.direction) {
    for (int i = 0; i < 3; ++i) check_coordinate(origin_[i], "revolution", "axis origin", 0);
    if (!is_finite(direction_) || !(length(direction_) > 1e-20))
        throw InvalidInput("revolution: the axis has no direction; specify a non-zero vector");
    direction_ = normalized(direction_);

    std::vector<std::vector<Vec2d>> contours(profile.contours().begin(), profile.contours().end());
    double radius = 0;
    const double slack = 1e-3 * profile.reach();  // splines may slightly overshoot the axis at their ends
    for (std::vector<Vec2d>& c : contours) {
        for (Vec2d& p : c) {
            if (p.x < -slack)
                throw InvalidInput(fmt::format(
                    "revolution: the profile reaches x = {:.6g}, beyond the axis; move it to x >= 0", p.x));
            p.x = std::max(p.x, 0.0);
            radius = std::max(radius, p.x);
        }
    }
    if (!(radius > 0))
        throw InvalidInput("revolution: all points of the profile are on the axis; move points to x > 0");
    if (!profile.closed()) contours = {mirrored(contours[0])};
    double area = 0;
    for (const std::vector<Vec2d>& c : contours) area = std::max(area, std::abs(contour_area(c)));
    const double size = std::max(radius, profile.reach());
    if (!(area > kMinContourArea * size * size))
        throw InvalidInput(
            "revolution: the profile encloses no volume; its points must not have the same height");
    std::vector<PlaneSegment> segments;
    for (const std::vector<Vec2d>& c : contours)
        for (std::size_t i = 0; i < c.size(); ++i)
            if (const PlaneSegment s{c[i], c[(i + 1) % c.size()]}; s.a != s.b) segments.push_back(s);
    index_ = ContourIndex(std::move(segments), true);

    for (const double y : {index_.low().y, index_.high().y}) {
        for (int i = 0; i < 3; ++i) {
            const double across = radius * std::sqrt(std::max(0.0, 1 - direction_[i] * direction_[i]));
            for (const double side : {-across, across}) {
                Vec3d p = origin_ + direction_ * y;
                p[i] += side;
                extend_outward(bounds_, p);
            }
        }
    }
}

void Revolution::distance(std::span<const Vec3> points, std::span<FieldSample> out) const {
    const Vec3d across = perpendicular(direction_);
    for (std::size_t i = 0; i < points.size(); ++i) {
        const Vec3d v = Vec3d(points[i]) - origin_;
        const double along = dot(v, direction_);
        const Vec3d from_axis = v - direction_ * along;
        const double r = length(from_axis);
        const PlaneSample s = index_.distance({r, along});
        const Vec3d radial = normalized(from_axis, across);
        out[i] = {static_cast<float>(s.value), Vec3(radial * s.gradient.x + direction_ * s.gradient.y)};
    }
}

}  // namespace coppice
