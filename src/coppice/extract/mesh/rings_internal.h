#pragma once

#include <cstdint>
#include <utility>
#include <vector>

#include "coppice/extract/mesh/surface_internal.h"

namespace coppice::extract_internal {

/// A curve round the surface on which the distance from the source has one value: closed, or an arc between
/// borders.
struct Ring {
    Vec3d center;                  ///< [m]
    double radius = 0;             ///< [m] mean distance from the axis through the center
    double spread = 0;             ///< standard deviation of that distance over the radius: 0 for a circle
    double level = 0;              ///< [m] distance from the source
    std::uint32_t parent = kNone;  ///< the ring next towards the source; kNone for the last
};

/// A run of rings from a farthest place towards the source, up to where the surface belongs to another chain.
struct RingChain {
    std::uint32_t first = 0, end = 0;  ///< its rings, the outermost first; at least one
    std::uint32_t tip = 0;             ///< the vertex that it starts from
    std::uint32_t touched = kNone;  ///< a ring of another chain that the tip borders on: the way round a loop
};

struct RingForest {
    std::vector<Ring> rings;
    std::vector<RingChain> chains;     ///< a chain ends at one that comes before it
    std::vector<std::uint32_t> claim;  ///< per vertex: the ring whose band it lies in, or kNone
};

/// Follows the surface from every farthest place towards the source, and takes rings on the way, 0.4
/// radii apart, until another chain has the same ring: the fork. What lies between a ring and the
/// next one tipward is its band. On a closed surface without handles the chains are the branches; a handle
/// gives a chain that ends at both sides, with `touched` set.
///
/// `distance` is from `march_distances`; vertices where it is infinite are left out. `from_border` tells for
/// each component whether its distances start at an open end: elsewhere the rings within 1.5 radii of the
/// source are no sections of a branch but rings of its cap, and left out like those at tips. O(n log n):
/// rings move apart when following them would take more than a bounded number of steps per triangle.
RingForest follow_chains(const Surface& surface, std::span<const double> distance,
                         std::span<const char> from_border, const Context& ctx);

}  // namespace coppice::extract_internal
