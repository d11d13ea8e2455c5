#pragma once

#include <cstdint>
#include <limits>
#include <vector>

#include "coppice/base/vec.h"

namespace coppice {

/// A node on a chain, as a ball.
struct ChainPoint {
    Vec3d position;        ///< [m]
    double radius;         ///< [m] > 0, that the segments really have there
    std::uint32_t node;    ///< the caller's own number for it
    double influence = 0;  ///< [radius] shift of the surface without the point; found by `simplify_chain`
};

/// What is left out between the ends of a chain.
struct ChainRule {
    double tolerance;      ///< [radius] how far the surface may move; >= 0
    double min_spacing;    ///< [radius] least distance of points, of the lesser radius; 0 = any
    bool leads = true;     ///< the chain starts with the radius of the node that it leaves, else with its own
    double fork_ball = 0;  ///< [m] of a lateral: no point but the first lies nearer to that one
    /// [radius] Of a point that is too near to the one before: how far the surface may move by leaving it
    /// out. Else the point moves on along its segment, by at most half of that.
    double max_shift = std::numeric_limits<double>::infinity();
};

/// What `simplify_chain` keeps.
struct SimplifiedChain {
    std::vector<ChainPoint> points;  ///< in order; the first and the last are those of the input
    std::uint32_t moved = 0;         ///< points moved along their segments, away from others
};

/// Chooses the points that the surface needs, by Douglas-Peucker on position and radius together, such that
/// no ball left out is farther than the tolerance from the new axis. Of two points nearer than the spacing
/// the one of less influence goes then, or the second moves on (see ChainRule::max_shift), unless the radius
/// jumps by more than a fifth between them: those are pushed apart, each along its own segment and by at most
/// a third of that. At least two points.
/// O(n log n), no recursion.
SimplifiedChain simplify_chain(std::vector<ChainPoint> points, const ChainRule& rule);

}  // namespace coppice
