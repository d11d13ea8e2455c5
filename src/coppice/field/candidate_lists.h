#pragma once

#include <cmath>
#include <cstdint>
#include <functional>
#include <span>
#include <vector>

#include "coppice/base/box.h"
#include "coppice/base/column.h"
#include "coppice/base/context.h"
#include "coppice/base/kernel/host_device.h"
#include "coppice/base/kernel/segment_distance.h"
#include "coppice/skeleton/skeleton.h"

namespace coppice {

/// A part of space about one segment, named by the segment's child node. A root names the segment to its
/// leader, or itself where the tree is a single node.
struct FieldRegion {
    Box3 box;     ///< [m] where it is sampled
    NodeId seed;  ///< names the segment
};

/// Where a segment has influence: a capsule and its box.
struct SegmentSupport {
    Box3 box;          ///< [m] holds the capsule
    Vec3 a;            ///< [m] one end of the axis, its extension included
    Vec3 b;            ///< [m] the other
    float radius = 0;  ///< [m] greatest
};

/// [m^2] From p to the axis of a support.
COPPICE_HOST_DEVICE inline float axis_distance_squared(const SegmentSupport& s, Vec3 p) {
    const Vec3 axis = s.b - s.a;
    return length_squared(p - s.a - closest_parameter(p, s.a, axis) * axis);
}

/// Whether the capsule may reach the box: by boxes, then by the ball about the box, which is the closer test
/// for a thin capsule that runs aslant.
COPPICE_HOST_DEVICE inline bool may_touch(const SegmentSupport& s, const Box3& box, Vec3 center,
                                          float half_diagonal) {
    if (!s.box.overlaps(box)) return false;
    const float reach = 1.0001f * (s.radius + half_diagonal);
    return axis_distance_squared(s, center) <= reach * reach;
}

/// How far p lies outside a support; negative within.
COPPICE_HOST_DEVICE inline float clearance(const SegmentSupport& s, Vec3 p) {
    return std::sqrt(axis_distance_squared(s, p)) - s.radius;
}

/// Lists of segments, ascending, one list per region: entries [first[i], first[i + 1]) of `segments`.
struct CandidateLists {
    std::vector<std::uint64_t> first{0};  ///< one more than there are regions
    Buffer<std::uint32_t> segments;       ///< by child node
};

/// No list of find_candidates() is longer than this, so that hubs and huge boxes cannot make time and memory
/// quadratic. It does not depend on how many regions there are: what lies elsewhere changes no list.
inline constexpr std::size_t kLongestList = 512;
/// The same for find_touching(), whose boxes may be few and large.
std::size_t longest_list(std::size_t regions);

/// Finds for every region the segments that matter in its box: those whose support touches the box and that
/// are connected to the seed through others that do. The seed is always among them. A branch that merely
/// passes by is not.
///
/// `supports` has one entry per node. O(sum of lists) whatever the size of the skeleton; the children of a
/// node with very many are found through a tree of boxes. A list that would be longer than kLongestList
/// keeps those with the fewest nodes between them and the seed.
CandidateLists find_candidates(const Skeleton& skeleton, std::span<const SegmentSupport> supports,
                               std::span<const FieldRegion> regions, const Context& ctx = {});

/// Whether a segment may be in the list of a region. Called by many threads at once.
using MayCount = std::function<bool(std::size_t region, NodeId segment)>;
/// The same, connected through segments alone that may be in the list; others take no place in it.
CandidateLists find_candidates(const Skeleton& skeleton, std::span<const SegmentSupport> supports,
                               std::span<const FieldRegion> regions, const MayCount& may_count,
                               const Context& ctx = {});

/// Finds for every box all segments whose support touches it, connected or not; supports of radius 0 are left
/// out. O((segments + regions) log n + lists). Of more than longest_list() the nearest to the box's center
/// are kept, as far as four times as many were looked at.
CandidateLists find_touching(std::span<const SegmentSupport> supports, std::span<const Box3> regions,
                             const Context& ctx = {});

}  // namespace coppice
