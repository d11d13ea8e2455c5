#include "coppice/implicit/shape/path_internal.h"

#include <fmt/format.h>

#include <numbers>

#include "coppice/base/error.h"
#include "coppice/base/frame.h"

namespace coppice {

PathFoot foot_in_arc(const Curve& path, CurvePlace place, Vec3d p) {
    const CurveArc& arc = path.arcs()[place.arc];
    PathFoot foot{.fraction = path.fraction(place), .frame = path.frame(place)};
    foot.offset = p - foot.frame.position;
    const Vec3d first = arc.first(place.t);
    const double speed = length_squared(first);
    // The fraction changes increasingly fast towards the centre of curvature; there it has no gradient.
    const double slope = std::max(speed - dot(foot.offset, arc.second(place.t)), 0.02 * speed);
    foot.by_point = foot.frame.tangent * (speed / (slope * path.length()));
    return foot;
}

PathFoot foot_at_end(const Curve& path, bool last, Vec3d p) {
    const CurvePlace place =
        last ? CurvePlace{static_cast<std::uint32_t>(path.arcs().size()) - 1, 1} : CurvePlace{0, 0};
    PathFoot foot{.fraction = last ? 1.0 : 0.0, .frame = path.frame(place)};
    foot.offset = p - foot.frame.position;
    foot.outward = foot.frame.tangent * (last ? 1.0 : -1.0);
    foot.beyond = std::max(dot(foot.offset, foot.outward), 0.0);
    return foot;
}

PathFoot foot_at_joint(const Curve& path, std::uint32_t before, std::uint32_t arc, Vec3d p) {
    PathFoot foot{.fraction = path.fraction({arc, 0}), .frame = path.frame({before, 1})};
    if (arc == 0) foot.fraction = 1;
    foot.offset = p - foot.frame.position;
    const Vec3d t1 = foot.frame.tangent, t2 = path.arcs()[arc].tangent(0);
    const Vec3d across = t1 * -dot(foot.offset, t2) + t2 * dot(foot.offset, t1);
    if (dot(t1, t2) > 1 - 1e-12) return foot;
    foot.frame.tangent = normalized(across, t1);
    foot.frame.normal = turned(foot.frame.normal, t1, foot.frame.tangent);
    foot.frame.binormal = cross(foot.frame.tangent, foot.frame.normal);
    return foot;
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
