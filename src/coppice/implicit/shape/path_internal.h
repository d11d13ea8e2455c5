#pragma once

#include <cmath>
#include <limits>
#include <string_view>

#include "coppice/implicit/polygonize/contour_index.h"
#include "coppice/implicit/shape/curve_internal.h"

namespace coppice {

/// Value, and derivatives by the coordinates in the plane perpendicular to the path and by the fraction of
/// its length.
struct PathSample {
    double value = 0;
    Vec2d gradient;
    double by_fraction = 0;
};

struct PathTurn {
    double roll = 0, twist = 0;  ///< [rad]
};

/// A place of the path with a perpendicular plane that contains a point, or an end of the path beyond which
/// the point is.
struct PathClosestPoint {
    double fraction = 0;
    Vec3d offset;        ///< from the path to the point
    CurveFrame frame;    ///< without the roll
    Vec3d by_point;      ///< [1/m] gradient of the fraction
    double beyond = -1;  ///< [m] >= 0: distance beyond an end, along `outward`
    Vec3d outward;
};

/// Calls visit(closest) for all such places nearer than limit + reach; visit may lower the limit. There is
/// always at least one.
template <class Visit>
void visit_closest_points(const Curve& path, Vec3d p, double reach, const double& limit, const Visit& visit);

/// Throws InvalidInput if the path turns back on itself at a corner, or the twist of a closed one is not a
/// whole number of turns.
void check_path(const Curve& path, const PathTurn& turn, std::string_view source);

/// Returns the box of profiles between low and high, scaled by scale(fraction) and transported along the
/// path.
template <class Scale>
Box3 swept_bounds(const Curve& path, const PathTurn& turn, Vec2d low, Vec2d high, const Scale& scale);

/// Returns the minimum of `value`(fraction, coordinates in the plane) over all visited places, with flat caps
/// at the ends of open paths; value must be at least the distance from the path minus `reach`.
template <class Value>
FieldSample sample_along(const Curve& path, const PathTurn& turn, Vec3 point, double reach,
                         const Value& value);

// Implementation.

struct RolledAxes {
    Vec3d x, y;
};

inline RolledAxes rolled(const CurveFrame& frame, const PathTurn& turn, double fraction) {
    const double angle = turn.roll + turn.twist * fraction;
    if (angle == 0) return {frame.normal, frame.binormal};
    const double c = std::cos(angle), s = std::sin(angle);
    return {frame.normal * c + frame.binormal * s, frame.binormal * c - frame.normal * s};
}

PathClosestPoint closest_point_in_arc(const Curve& path, CurvePlace place, Vec3d p);
PathClosestPoint closest_point_at_end(const Curve& path, bool last, Vec3d p);
/// At the start of an arc where the previous one ends: at a corner the frame is rotated until its plane
/// contains the point.
PathClosestPoint closest_point_at_joint(const Curve& path, std::uint32_t before, std::uint32_t arc, Vec3d p);

template <class Visit>
void visit_closest_points(const Curve& path, Vec3d p, double reach, const double& limit, const Visit& visit) {
    const auto arcs = path.arcs();
    const auto last = static_cast<std::uint32_t>(arcs.size()) - 1;
    const auto near_enough = [&](std::uint32_t l, std::uint32_t i) {
        return std::sqrt(distance_squared(path.boxes().level(l)[i], p)) - reach;
    };
    path.boxes().search(near_enough, limit, [&](std::uint32_t i) {
        const double g0 = distance_slope(arcs[i], p, 0), g1 = distance_slope(arcs[i], p, 1);
        if (const double t = local_closest_parameter(arcs[i], p, g0, g1); t >= 0) {
            if (length(arcs[i].position(t) - p) - reach < limit) visit(closest_point_in_arc(path, {i, t}, p));
        }
        if (g0 >= 0) {
            if (i > 0 || path.closed()) {
                const std::uint32_t before = i > 0 ? i - 1 : last;
                if (distance_slope(arcs[before], p, 1) <= 0)
                    visit(closest_point_at_joint(path, before, i, p));
            } else {
                visit(closest_point_at_end(path, false, p));
            }
        }
        if (i == last && !path.closed() && g1 <= 0) visit(closest_point_at_end(path, true, p));
    });
}

/// Clips an open path at its caps: the cap determines the value of points that are deeper than their nearest
/// cap.
inline void cut_by_caps(const PathClosestPoint& closest, double length, double& value, Vec3d& gradient) {
    const double before = -closest.fraction * length, after = -(1 - closest.fraction) * length;
    if (value >= before && value >= after) return;
    value = std::max(before, after);
    gradient = closest.by_point * (before > after ? -length : length);
}

template <class Value>
FieldSample sample_along(const Curve& path, const PathTurn& turn, Vec3 point, double reach,
                         const Value& value) {
    double best = std::numeric_limits<double>::infinity();
    Vec3d gradient;
    const double rate = turn.twist + path.closing_roll();
    visit_closest_points(path, Vec3d(point), reach, best, [&](const PathClosestPoint& closest) {
        const RolledAxes axes = rolled(closest.frame, turn, closest.fraction);
        const Vec2d q{dot(closest.offset, axes.x), dot(closest.offset, axes.y)};
        const PathSample s = value(closest.fraction, q);
        double d = s.value;
        Vec3d g = axes.x * s.gradient.x + axes.y * s.gradient.y;
        if (closest.beyond >= 0) {
            if (d <= 0) {
                d = closest.beyond;
                g = closest.outward;
            } else {
                const double whole = std::hypot(d, closest.beyond);
                g = (g * d + closest.outward * closest.beyond) / whole;
                d = whole;
            }
        } else {
            const double turning = rate * (s.gradient.x * q.y - s.gradient.y * q.x);
            g += closest.by_point * (s.by_fraction + turning);
            if (!path.closed()) cut_by_caps(closest, path.length(), d, g);
        }
        if (!(d < best)) return;
        best = d;
        gradient = g;
    });
    return {static_cast<float>(best), Vec3(gradient)};
}

template <class Scale>
Box3 swept_bounds(const Curve& path, const PathTurn& turn, Vec2d low, Vec2d high, const Scale& scale) {
    Box3 box;
    const auto add = [&](CurvePlace place, double slack) {
        const CurveFrame frame = path.frame(place);
        const double fraction = path.fraction(place), s = scale(fraction);
        const RolledAxes axes = rolled(frame, turn, fraction);
        for (const double x : {low.x * s, high.x * s})
            for (const double y : {low.y * s, high.y * s})
                for (const double side : {-slack, slack})
                    extend_outward(box, frame.position + axes.x * x + axes.y * y + Vec3d(side, side, side));
    };
    const double reach = std::max({std::abs(low.x), std::abs(high.x), std::abs(low.y), std::abs(high.y)});
    for (std::uint32_t i = 0; i < path.arcs().size(); ++i) {
        const CurveArc& arc = path.arcs()[i];
        // Between steps a corner of the profile deviates from the line by at most angle squared / 8 of its
        // arm.
        const double bend = 2 * std::sqrt(std::max(0.0, 2 - 2 * dot(arc.tangent(0), arc.tangent(1))));
        const double angle = bend + std::abs(turn.twist + path.closing_roll()) * arc.length / path.length();
        const int steps = 1 + std::min(63, static_cast<int>(angle / 0.1));
        const double step = angle / steps;
        const double arm = 1.5 * reach * std::max(scale(path.fraction({i, 0})), scale(path.fraction({i, 1})));
        const double slack = std::min(step * step / 4, 2.0) * arm + (angle > 0 ? arc.slack : 0);
        for (int k = 0; k <= steps; ++k) add({i, static_cast<double>(k) / steps}, slack);
        const std::uint32_t next = i + 1 < path.arcs().size() ? i + 1 : 0;
        if (next == 0 && !path.closed()) continue;
        // At a corner of a polyline the profile rotates about the joint.
        if (dot(arc.tangent(1), path.arcs()[next].tangent(0)) < 1 - 1e-9) add({i, 1}, arm);
    }
    return box;
}

}  // namespace coppice
