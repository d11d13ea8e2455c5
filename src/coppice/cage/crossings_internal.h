#pragma once

#include <vector>

#include "coppice/base/context.h"
#include "coppice/cage/axes_internal.h"
#include "coppice/skeleton/skeleton.h"

namespace coppice::cage_internal {

/// Two segments of which the one laid down later runs inside the other for a part.
struct Crossing {
    NodeId junior, senior;
    bool ordinary;  ///< a lateral that leaves a branch at their common node
};

/// A part [from, to] of a segment, from the end at the parent.
struct Part {
    Segment segment;
    float from = 0, to = 1;
};

/// A point of one segment as another one sees it.
struct Sight {
    float gap;    ///< [m] below 0: inside
    float t;      ///< the nearest point of the host's axis
    Vec3 across;  ///< [m] from there to the point
};

/// An axis is inside another one while it is nearer than the greater of that one's radius and a share of the
/// sum of both radii.
class Insideness {
  public:
    explicit Insideness(float share_of_sum) : share_(share_of_sum) {}

    float least_distance(float host, float own) const { return std::max(host, share_ * (host + own)); }
    Sight see(const Part& host, const Segment& own, float at) const;

    /// Where a segment comes nearest to a host.
    static float nearest(const Segment& own, const Part& host);

    /// Where, on the way from `in` to `out`, a segment has left a host by a gap. The distance to a segment is
    /// convex, so that there is one such place on each side of the nearest point.
    float leave(const Part& host, const Segment& own, float in, float out, float gap = 0) const;

  private:
    float share_;
};

/// [radii of the junior] A branch has left another one, surface and all, with this gap.
inline constexpr float kClear = 0.8f;

/// All crossings within trees, by junior, then senior. O(n log n) unless most boxes of segments overlap, for
/// which the search is limited.
std::vector<Crossing> find_crossings(const Skeleton& skeleton, const Axes& axes, const Insideness& inside,
                                     const Context& ctx);

}  // namespace coppice::cage_internal
