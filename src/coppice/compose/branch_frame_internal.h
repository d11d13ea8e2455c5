#pragma once

#include <vector>

#include "coppice/skeleton/skeleton.h"

namespace coppice::compose_internal {

inline constexpr Vec3d kUp{0, 0, 1};
/// [radii of the parent branch] length over which directions are computed
inline constexpr double kReach = 2;

/// Three orthonormal, right-handed vectors.
struct Frame {
    Vec3d x, y, z;

    Vec3d to_local(Vec3d v) const { return {dot(v, x), dot(v, y), dot(v, z)}; }
    Vec3d to_world(Vec3d v) const { return x * v.x + y * v.y + z * v.z; }
};

/// Returns a frame with z along `direction` and `parent_direction` in the half plane of z and +x; an
/// arbitrary such frame if the two are parallel.
Frame branch_frame(Vec3d direction, Vec3d parent_direction);

/// Returns the frame rotated about its z by an angle [rad], counter-clockwise seen against z.
Frame rolled(const Frame& frame, double angle);

/// Returns the direction in which the branch with the first node `first` leaves its branch node: towards the
/// point of its axis at two radii of the parent branch, or towards the end of its first segment if that is
/// farther.
Vec3d branch_direction(const Skeleton& skeleton, NodeId first);

/// Returns the direction in which the axis arrives at a branch node, computed over the same length; up at a
/// root.
Vec3d compute_parent_direction(const Skeleton& skeleton, NodeId node);

/// Returns the unit vector from `start` to the point at the length `way` along a chain of nodes that begins
/// at `first`, or to the first node if that is farther; up if the two points coincide. `next` of the last
/// node is `none`.
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

/// Per node: sizes of the branch that begins with the segment to it.
struct BranchSizes {
    std::vector<double> length;         ///< [m] total length of its segments
    std::vector<std::uint32_t> orders;  ///< as in ChildTreeMeasures

    explicit BranchSizes(const Skeleton& skeleton);
};

}  // namespace coppice::compose_internal
