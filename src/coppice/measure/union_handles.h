#pragma once

#include <cstdint>
#include <optional>

#include "coppice/base/context.h"
#include "coppice/measure/capsule_tree.h"
#include "coppice/skeleton/skeleton.h"

namespace coppice {

/// Handles of a surface and of the solid that it describes.
struct HandlesReport {
    std::int64_t surface = 0;  ///< number of handles of all components of the surface
    std::int64_t cones = 0;    ///< number of handles of the union of the skeleton's rounded cones
    friend bool operator==(const HandlesReport&, const HandlesReport&) = default;  ///< member by member
};

/// Returns the number of handles of the union of the rounded cones of a skeleton: of the independent loops of
/// its branches through places at which they overlap. A tree with branches that do not overlap has none.
/// `capsules` must be the segments of the skeleton, and may contain balls of roots. Flat ends are ignored.
///
/// As cones are convex, the union has the loops of their nerve: the graph of the pairs of cones with common
/// points, in which a cycle counts only if it is not the sum of triangles, the triples of cones with common
/// points. Here a cone is the convex hull of its two balls. Common points of three cones are found by
/// successive projections, to a thousandth of the radius; smaller gaps are ignored. O(pairs log pairs) where
/// few pairs make loops, about a microsecond a pair. Returns nullopt if the boxes of a cone overlap those of
/// more than 100 others on average. Throws Cancelled.
std::optional<std::int64_t> count_union_handles(const CapsuleTree& capsules, const Skeleton& skeleton,
                                                const Context& ctx = {});

/// Calls visit(name, value) for every member, in order.
template <class Visitor>
void visit_figures(const HandlesReport& r, Visitor&& visit) {
    visit("surface", r.surface);
    visit("cones", r.cones);
}

}  // namespace coppice
