#include "coppice/implicit/shape/path_internal.h"

#include <fmt/format.h>

#include <numbers>

#include "coppice/base/error.h"
#include "coppice/base/frame.h"

namespace coppice {

PathClosestPoint closest_point_in_arc(const Curve& path, CurvePlace place, Vec3d p) {
    const CurveArc& arc = path.arcs()[place.arc];
    PathClosestPoint closest{.fraction = path.fraction(place), .frame = path.frame(place)};
    closest.offset = p - closest.frame.position;
    const Vec3d first = arc.first(place.t);
    const double speed = length_squared(first);
    // The fraction changes increasingly fast towards the centre of curvature; there it has no gradient.
    const double slope = std::max(speed - dot(closest.offset, arc.second(place.t)), 0.02 * speed);
    closest.by_point = closest.frame.tangent * (speed / (slope * path.length()));
    return closest;
}

PathClosestPoint closest_point_at_end(const Curve& path, bool last, Vec3d p) {
    const CurvePlace place =
        last ? CurvePlace{static_cast<std::uint32_t>(path.arcs().size()) - 1, 1} : CurvePlace{0, 0};
    PathClosestPoint closest{.fraction = last ? 1.0 : 0.0, .frame = path.frame(place)};
    closest.offset = p - closest.frame.position;
    closest.outward = closest.frame.tangent * (last ? 1.0 : -1.0);
    closest.beyond = std::max(dot(closest.offset, closest.outward), 0.0);
    return closest;
}

PathClosestPoint closest_point_at_joint(const Curve& path, std::uint32_t before, std::uint32_t arc, Vec3d p) {
    PathClosestPoint closest{.fraction = path.fraction({arc, 0}), .frame = path.frame({before, 1})};
    if (arc == 0) closest.fraction = 1;
    closest.offset = p - closest.frame.position;
    const Vec3d t1 = closest.frame.tangent, t2 = path.arcs()[arc].tangent(0);
    const Vec3d across = t1 * -dot(closest.offset, t2) + t2 * dot(closest.offset, t1);
    if (dot(t1, t2) > 1 - 1e-12) return closest;
    closest.frame.tangent = normalized(across, t1);
    closest.frame.normal = turned(closest.frame.normal, t1, closest.frame.tangent);
    closest.frame.binormal = cross(closest.frame.tangent, closest.frame.normal);
    return closest;
}

void check_path(const Curve& path, const PathTurn& turn, std::string_view source) {
    const auto arcs = path.arcs();
    for (std::size_t i = 0; i < arcs.size(); ++i) {
        if (i + 1 == arcs.size() && !path.closed()) break;
        if (dot(arcs[i].tangent(1), arcs[(i + 1) % arcs.size()].tangent(0)) < -0.99) {
            const Vec3d at = arcs[i].position(1);
            throw InvalidInput(
                fmt::format("{}: the path turns back on itself at ({:.6g}, {:.6g}, {:.6g}); round the turn "
                            "with additional points",
                            source, at.x, at.y, at.z));
        }
    }
    const double turns = turn.twist / (2 * std::numbers::pi);
    if (path.closed() && std::abs(turns - std::round(turns)) > 1e-4)
        throw InvalidInput(fmt::format(
            "{}: twist must be a whole number of turns (6.283185 each) along a closed path, but is {}",
            source, turn.twist));
}

}  // namespace coppice
