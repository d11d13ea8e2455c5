#pragma once

#include <vector>

#include "coppice/base/context.h"
#include "coppice/cage/axes_internal.h"
#include "coppice/skeleton/skeleton.h"

namespace coppice::cage_internal {

/// Two segments of which the one of greater rank runs inside the other for a part.
struct Crossing {
    NodeId segment, host;
    bool ordinary;  ///< a lateral that leaves a branch at their common node
};

/// A part [from, to] of a segment, from the end at the parent.
struct Part {
    Segment segment;
    float from = 0, to = 1;
};

/// How far a point of one segment is from being inside another one, its host.
struct Clearance {
    float gap;    ///< [m] below 0: inside
    float t;      ///< the nearest point of the host's axis
    Vec3 offset;  ///< [m] from there to the point
};

/// An axis is inside another one while it is nearer than the greater of that one's radius and a share of the
/// sum of both radii.
class Enclosure {
  public:
    explicit Enclosure(float share_of_sum) : share_(share_of_sum) {}

    float least_distance(float host, float own) const { return std::max(host, share_ * (host + own)); }
    Clearance clearance(const Part& host, const Segment& own, float at) const;

    /// Where, on the way from `in` to `out`, a segment has left a host by a gap. The distance to a segment is
    /// convex, so that there is one such place on each side of the nearest point.
    float exit(const Part& host, const Segment& own, float in, float out, float gap = 0) const;

  private:
    float share_;
};

/// Where a segment comes nearest to a host.
float nearest_parameter(const Segment& own, const Part& host);

/// [radii of the inner one] A branch has left another one, surface and all, with this gap.
inline constexpr float kClear = 0.8f;

/// All crossings, of one tree or two, by segment, then host. O(n log n) unless most boxes of segments
/// overlap, for which the search is limited.
std::vector<Crossing> find_crossings(const Skeleton& skeleton, const Axes& axes, const Enclosure& enclosure,
                                     const Context& ctx);

}  // namespace coppice::cage_internal
