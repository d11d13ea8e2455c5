#pragma once

#include "coppice/base/kernel/round_cone.h"
#include "coppice/skeleton/skeleton.h"

namespace coppice {

/// A segment with the queries of a round cone, in the precision of T.
template <class T = double>
BasicRoundCone<T> round_cone(const Segment& s) {
    return round_cone(BasicVec3<T>(s.a), BasicVec3<T>(s.b), T{s.radius_a}, T{s.radius_b});
}

}  // namespace coppice
