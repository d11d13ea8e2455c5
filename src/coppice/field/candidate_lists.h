#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "coppice/base/box.h"
#include "coppice/base/column.h"
#include "coppice/base/context.h"
#include "coppice/skeleton/skeleton.h"

namespace coppice {

/// A part of space about one segment, named by the segment's lower node. A root names the segment to its
/// leader, or itself where the tree is a single node.
struct FieldRegion {
    Box3 box;
    NodeId seed;
};

/// Where a segment has influence: a capsule and its box.
struct SegmentSupport {
    Box3 box;
    Vec3 a, b;         ///< [m] ends, extensions included
    float radius = 0;  ///< [m] greatest
};

/// Whether the capsule may reach the box: by boxes, then by the ball about the box, which is the closer test
/// for a thin capsule that runs aslant.
inline bool may_touch(const SegmentSupport& s, const Box3& box, Vec3 center, float half_diagonal) {
    if (!s.box.overlaps(box)) return false;
    const Vec3 axis = s.b - s.a;
    const Vec3 w = center - s.a;
    const float along = dot(w, axis), length2 = length_squared(axis);
    const float t = along <= 0 ? 0 : along >= length2 ? 1 : along / length2;
    const float reach = 1.0001f * (s.radius + half_diagonal);
    return length_squared(w - t * axis) <= reach * reach;
}

/// Lists of segments, ascending, one list per region: entries [first[i], first[i + 1]) of `segments`.
struct CandidateLists {
    std::vector<std::uint64_t> first{0};
    Buffer<std::uint32_t> segments;  ///< by lower node
};

/// No list is longer than this, so that hubs and huge boxes cannot make time and memory quadratic.
std::size_t longest_list(std::size_t regions);

/// Finds for every region the segments that matter in its box: those whose support touches the box and that
/// hang together with the seed through others that do. The seed is always among them. A branch that merely
/// passes by is not.
///
/// `supports` has one entry per node. O(sum of lists) whatever the size of the skeleton; the children of a
/// node with very many are found through a tree of boxes. A list that would be longer than longest_list()
/// keeps those with the fewest nodes between them and the seed.
CandidateLists find_candidates(const Skeleton& skeleton, std::span<const SegmentSupport> supports,
                               std::span<const FieldRegion> regions, const Context& ctx = {});

}  // namespace coppice
