#pragma once

#include <cstdint>
#include <utility>
#include <vector>

#include "coppice/base/id.h"
#include "coppice/extract/mesh/surface_internal.h"

namespace coppice::extract_internal {

/// Curve around the surface on which the distance from the source is constant: closed, or an arc between
/// borders.
struct Ring {
    Vec3d center;       ///< [m]
    double radius = 0;  ///< [m] mean distance from the axis through the centre
    double spread = 0;  ///< standard deviation of that distance divided by the radius: 0 for a circle
    double level = 0;   ///< [m] distance from the source
    std::uint32_t parent = kNoIndex;  ///< next ring towards the source; kNoIndex for the last one
};

/// Sequence of rings from a local maximum of the distance towards the source, up to where the surface belongs
/// to another chain.
struct RingChain {
    std::uint32_t first = 0, end = 0;  ///< range of its rings, outermost first; at least one
    std::uint32_t tip = 0;             ///< vertex that it starts from
    std::uint32_t touched = kNoIndex;  ///< ring of another chain adjacent to the tip, which closes a loop
};

struct RingForest {
    std::vector<Ring> rings;
    std::vector<RingChain> chains;     ///< a chain ends at one that precedes it
    std::vector<std::uint32_t> claim;  ///< per vertex: the ring of its band, or kNoIndex
};

/// Follows the surface from every local maximum of the distance towards the source and places rings at
/// intervals of 0.4 radii until another chain has the same ring: the fork. The band of a ring is the surface
/// between it and the next one tipward. On a closed surface without handles the chains are the branches; a
/// handle produces a chain that ends at both sides, with `touched` set.
///
/// `distance` is the result of `march_distances`; vertices with infinite distance are ignored. `from_border`
/// states for each component whether its distances start at an open end: elsewhere the rings within 1.5 radii
/// of the source belong to its cap, are not cross-sections of a branch, and are omitted like those at tips.
/// O(n log n): the distance of rings increases when the traversal would exceed a bounded number of steps per
/// triangle.
RingForest follow_chains(const Surface& surface, std::span<const double> distance,
                         std::span<const char> from_border, const Context& ctx);

}  // namespace coppice::extract_internal
