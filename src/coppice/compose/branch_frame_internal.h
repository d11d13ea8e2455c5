#pragma once

#include <vector>

#include "coppice/skeleton/skeleton.h"

namespace coppice::compose_internal {

inline constexpr Vec3d kUp{0, 0, 1};
inline constexpr double kReach = 2;  ///< [radii of the host] over which directions are taken

/// Three unit vectors, right-handed.
struct Frame {
    Vec3d x, y, z;

    Vec3d to_local(Vec3d v) const { return {dot(v, x), dot(v, y), dot(v, z)}; }
    Vec3d to_world(Vec3d v) const { return x * v.x + y * v.y + z * v.z; }
};

/// z along `direction`, and `host` in the half plane of z and +x; any such frame where the two are parallel.
Frame branch_frame(Vec3d direction, Vec3d host);

/// The frame turned about its z, counter-clockwise seen against it, by an angle [rad].
Frame rolled(const Frame& frame, double angle);

/// The direction in which the branch whose first node is `first` leaves its node: to where its axis is after
/// two radii of the host, or after its first segment.
Vec3d branch_direction(const Skeleton& skeleton, NodeId first);

/// The direction in which the axis arrives at a branch node, over as long a way; up at a root.
Vec3d host_direction(const Skeleton& skeleton, NodeId node);

/// Unit; from `start` to where a chain of nodes from `first` on is after `way`, at its first node at least;
/// up where that is the same place. `next` of the last node is `none`.
template <class Node, class Position, class Next>
Vec3d direction_along(Vec3d start, Node first, double way, const Position& position, const Next& next,
                      Node none) {
    Vec3d at = start;
    for (Node n = first; n != none && way > 0; n = next(n)) {
        const Vec3d to = position(n);
        const double step = distance(at, to);
        at = step > way && n != first ? lerp(at, to, way / step) : to;
        way -= step;
    }
    return normalized(at - start, kUp);
}

/// Per node, of the branch that begins with the segment to it.
struct BranchSizes {
    std::vector<double> length;         ///< [m] of its segments
    std::vector<std::uint32_t> orders;  ///< as in ChildTreeMeasures

    explicit BranchSizes(const Skeleton& skeleton);
};

}  // namespace coppice::compose_internal
