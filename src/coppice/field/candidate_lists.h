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

/// A region of space around one segment, identified by the segment's child node. A root identifies the
/// segment to its leader, or itself if the tree is a single node.
struct FieldRegion {
    Box3 box;     ///< [m] where the field is sampled
    NodeId seed;  ///< identifies the segment
};

/// The support of a segment: a capsule and its box.
struct SegmentSupport {
    Box3 box;          ///< [m] box of the capsule
    Vec3 a;            ///< [m] start of the axis, including its extension
    Vec3 b;            ///< [m] end of the axis, including its extension
    float radius = 0;  ///< [m] maximum
};

/// [m^2] Returns the squared distance from p to the axis of a support.
COPPICE_HOST_DEVICE inline float axis_distance_squared(const SegmentSupport& s, Vec3 p) {
    const Vec3 axis = s.b - s.a;
    return length_squared(p - s.a - closest_parameter(p, s.a, axis) * axis);
}

/// Returns whether the capsule may intersect the box: tests the boxes, then the ball around the box, which is
/// tighter for a thin diagonal capsule.
COPPICE_HOST_DEVICE inline bool may_touch(const SegmentSupport& s, const Box3& box, Vec3 center,
                                          float half_diagonal) {
    if (!s.box.overlaps(box)) return false;
    const float reach = 1.0001f * (s.radius + half_diagonal);
    return axis_distance_squared(s, center) <= reach * reach;
}

/// Returns the distance from p to a support; negative inside.
COPPICE_HOST_DEVICE inline float clearance(const SegmentSupport& s, Vec3 p) {
    return std::sqrt(axis_distance_squared(s, p)) - s.radius;
}

/// Sorted lists of segments, one list per region: entries [first[i], first[i + 1]) of `segments`.
struct CandidateLists {
    std::vector<std::uint64_t> first{0};  ///< number of regions + 1 offsets
    Buffer<std::uint32_t> segments;       ///< by child node
};

/// Maximum length of a list of find_candidates(), so that hubs and huge boxes cannot make time and memory
/// quadratic. It does not depend on the number of regions, so that distant regions do not change a list.
inline constexpr std::size_t kLongestList = 512;
/// Returns the maximum length of a list of find_touching(), which may have few, large boxes.
std::size_t longest_list(std::size_t regions);

/// Finds the relevant segments of every region: segments with a support that touches the box and that are
/// connected to the seed through other such segments. The seed is always included. A branch that merely
/// passes by is not.
///
/// `supports` has one entry per node. O(sum of lists), independent of the size of the skeleton; the children
/// of nodes with many children are found through a box tree. A longer list is truncated to kLongestList: the
/// segments with the fewest nodes between them and the seed are kept.
CandidateLists find_candidates(const Skeleton& skeleton, std::span<const SegmentSupport> supports,
                               std::span<const FieldRegion> regions, const Context& ctx = {});

/// Returns whether a segment may be in the list of a region. Must be thread safe.
using MayCount = std::function<bool(std::size_t region, NodeId segment)>;
/// The same, connected only through segments that may be in the list; other segments do not count towards its
/// length.
CandidateLists find_candidates(const Skeleton& skeleton, std::span<const SegmentSupport> supports,
                               std::span<const FieldRegion> regions, const MayCount& may_count,
                               const Context& ctx = {});

/// Finds for every box all segments with a support that touches it, connected or not; supports of radius 0
/// are ignored. O((segments + regions) log n + lists). A list longer than longest_list() keeps the segments
/// nearest to the box's centre, of at most four times as many examined segments.
CandidateLists find_touching(std::span<const SegmentSupport> supports, std::span<const Box3> regions,
                             const Context& ctx = {});

}  // namespace coppice
