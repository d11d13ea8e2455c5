#pragma once

#include <vector>

#include "coppice/base/context.h"
#include "coppice/cage/axes_internal.h"
#include "coppice/skeleton/skeleton.h"

namespace coppice::cage_internal {

/// Two segments of which the one of greater rank runs partly inside the other.
struct Crossing {
    NodeId segment, parent;
    bool ordinary;  ///< a lateral that leaves a branch at their common node
};

/// The section [from, to] of a segment, from the end at the parent.
struct SegmentRange {
    Segment segment;
    float from = 0, to = 1;
};

/// Distance of a point of one segment from the inside of another one, its parent branch.
struct Clearance {
    float gap;    ///< [m] negative inside
    float t;      ///< parameter of the closest point of the parent's axis
    Vec3 offset;  ///< [m] from there to the point
};

/// Test whether an axis is inside another one: it is while it is closer than the greater of that one's radius
/// and a share of the sum of both radii.
class Enclosure {
  public:
    explicit Enclosure(float share_of_sum) : share_(share_of_sum) {}

    float min_distance(float parent, float own) const { return std::max(parent, share_ * (parent + own)); }
    Clearance clearance(const SegmentRange& parent, const Segment& own, float at) const;

    /// Returns the parameter, between `in` and `out`, at which a segment has left a parent branch by a gap.
    /// The distance to a segment is convex, so that there is one such position on each side of the closest
    /// point.
    float exit(const SegmentRange& parent, const Segment& own, float in, float out, float gap = 0) const;

  private:
    float share_;
};

/// Returns the parameter at which a segment is closest to a parent branch.
float nearest_parameter(const Segment& own, const SegmentRange& parent);

/// [radii of the inner branch] Gap beyond which a branch has left another one, including its surface.
inline constexpr float kClear = 0.8f;

/// Returns all crossings, of one tree or two, by segment, then parent branch. O(n log n) unless most boxes of
/// segments overlap, in which case the search is limited.
std::vector<Crossing> find_crossings(const Skeleton& skeleton, const Axes& axes, const Enclosure& enclosure,
                                     const Context& ctx);

}  // namespace coppice::cage_internal
