#pragma once

#include "coppice/base/kernel/round_cone.h"
#include "coppice/skeleton/skeleton.h"

namespace coppice {

/// Returns the segment as a round cone, in the precision of T.
template <class T = double>
BasicRoundCone<T> round_cone(const Segment& s) {
    return round_cone(BasicVec3<T>(s.a), BasicVec3<T>(s.b), T{s.radius_a}, T{s.radius_b});
}

/// Returns whether a root is a ball at which several segments begin, such as a soma: it has several children,
/// and it protrudes from the cone of its leader because the radius changes steeply.
inline bool is_ball(const Skeleton& s, NodeId root) {
    constexpr float kSteep = 0.25f;
    if (s.children(root).size() < 2) return false;
    const NodeId c = s.leader(root);
    return s.radius(root) - s.radius(c) > kSteep * distance(s.position(root), s.position(c));
}

}  // namespace coppice
