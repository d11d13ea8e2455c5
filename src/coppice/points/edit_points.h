#pragma once

#include <array>
#include <cstdint>
#include <string_view>

#include "coppice/base/context.h"
#include "coppice/base/fields.h"
#include "coppice/implicit/field_ref.h"
#include "coppice/points/point_set.h"
#include "coppice/points/sampling/lane.h"

namespace coppice {

/// Which points go.
struct RemoveRandomOptions {
    float percent = 50;  ///< how many of the points inside go
    int seed = 0;        ///< which of them
};

template <class Self, class Visitor>
requires SameOptions<Self, RemoveRandomOptions>
constexpr void visit_fields(Self& o, Visitor&& visit) {
    visit(Field{"percent", "how many of the points inside are removed", Unit::none, 0, 100}, o.percent);
    visit(Field{"seed", "another seed removes others", Unit::none, 0, 2147483647}, o.seed);
}

/// The points without a share of those inside a solid (value > level at origin + position): exactly the
/// rounded percentage of them, chosen at random. The others keep their order. O(n log n) and one evaluation
/// of the field for each point. Throws InvalidInput for options out of range.
PointSet remove_random(const PointSet& points, const FieldRef& solid, const RemoveRandomOptions& options = {},
                       const Context& ctx = {});

/// The points and behind them new ones in a region, placed by Lane's method as if after the ones there are,
/// so that new points keep the kernel's core from old ones too. See `sample_lane`.
PointSet densified(const PointSet& points, const PointRegion& region, const RadialKernel& kernel,
                   const LaneOptions& options = {}, const Context& ctx = {});

}  // namespace coppice
