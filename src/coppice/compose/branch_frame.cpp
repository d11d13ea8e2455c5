#include <algorithm>
#include <cmath>

#include "coppice/compose/branch_frame_internal.h"

namespace coppice::compose_internal {
namespace {

Vec3d place(const Skeleton& s, NodeId n) { return Vec3d(s.position(n)); }

Vec3d direction_from(const Skeleton& s, NodeId node, NodeId first, NodeId (Skeleton::*next)(NodeId) const) {
    return direction_along(
        place(s, node), first, kReach * double{s.radius(node)}, [&](NodeId n) { return place(s, n); },
        [&](NodeId n) { return (s.*next)(n); }, NodeId::none());
}

}  // namespace

Frame branch_frame(Vec3d direction, Vec3d parent_direction) {
    const Vec3d across = parent_direction - direction * dot(parent_direction, direction);
    const Vec3d x = length(across) > 1e-6 ? normalized(across) : perpendicular(direction);
    return {x, cross(direction, x), direction};
}

Frame rolled(const Frame& frame, double angle) {
    const double c = std::cos(angle), s = std::sin(angle);
    return {frame.x * c + frame.y * s, frame.y * c - frame.x * s, frame.z};
}

Vec3d branch_direction(const Skeleton& s, NodeId first) {
    return direction_from(s, s.parent(first), first, &Skeleton::leader);
}

Vec3d compute_parent_direction(const Skeleton& s, NodeId node) {
    return s.is_root(node) ? kUp : -direction_from(s, node, s.parent(node), &Skeleton::parent);
}

BranchSizes::BranchSizes(const Skeleton& s) : length(s.size(), 0), orders(s.size(), 1) {
    for (std::uint32_t i = s.size(); i-- > 0;) {
        const NodeId n(i);
        if (s.is_root(n)) continue;
        const NodeId p = s.parent(n);
        length[i] += distance(place(s, n), place(s, p));
        length[p.index()] += length[i];
        const std::uint32_t own = orders[i] + (s.leader(p) == n ? 0 : 1);
        orders[p.index()] = std::max(orders[p.index()], own);
    }
}

}  // namespace coppice::compose_internal
