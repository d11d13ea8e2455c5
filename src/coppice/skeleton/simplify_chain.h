#pragma once

#include <cstdint>
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
    double fork_ball = 0;  ///< [m] of a lateral: no point but the first lies nearer to that
};

/// What `simplify_chain` keeps.
struct SimplifiedChain {
    std::vector<ChainPoint> points;  ///< in order; the first and the last are those of the input
    std::uint32_t moved = 0;         ///< points pushed apart, so that a jump in radius keeps both its radii
};

/// Chooses the points that the surface needs, by Douglas-Peucker on position and radius together, such that
/// no ball left out is farther than the tolerance from the new axis. Of two points nearer than the spacing
/// the one of less influence goes then, unless the radius jumps by more than a fifth between them: those are
/// pushed apart, each along its own segment and by at most a third of that. At least two points.
/// O(n log n), no recursion.
SimplifiedChain simplify_chain(std::vector<ChainPoint> points, const ChainRule& rule);

}  // namespace coppice
