#pragma once

#include <cstdint>
#include <limits>
#include <vector>

#include "coppice/base/vec.h"

namespace coppice {

/// A node of a chain, as a ball.
struct ChainPoint {
    Vec3d position;        ///< [m]
    double radius;         ///< [m] > 0; radius of the segments at this point
    std::uint32_t node;    ///< number chosen by the caller
    double influence = 0;  ///< [radius] shift of the surface without the point; computed by `simplify_chain`
};

/// Rule for removing points between the ends of a chain.
struct ChainRule {
    double tolerance;    ///< [radius] maximum shift of the surface; >= 0
    double min_spacing;  ///< [smaller radius] minimum distance of points; 0: any
    /// whether the chain begins with the radius of its branching node rather than its own
    bool leads = true;
    double fork_ball = 0;  ///< [m] for laterals: minimum distance of the other points from the first one
    /// [radius] maximum shift of the surface by removing a point that is too close to the previous one.
    /// Otherwise the point is moved along its segment, by at most half of it.
    double max_shift = std::numeric_limits<double>::infinity();
};

/// Result of `simplify_chain`.
struct SimplifiedChain {
    std::vector<ChainPoint> points;  ///< in order; includes the first and the last of the input
    std::uint32_t moved = 0;         ///< number of points moved along their segments
};

/// Chooses the points that determine the surface, by Douglas-Peucker on position and radius together: the
/// distance of every removed ball from the new axis is at most the tolerance. Then, of two points closer than
/// the spacing, the one with less influence is removed, or the second one is moved (see
/// ChainRule::max_shift), unless the radius changes by more than a fifth between them: those are moved apart,
/// each along its own segment and by at most a third of it. Requires at least two points. O(n log n), not
/// recursive.
SimplifiedChain simplify_chain(std::vector<ChainPoint> points, const ChainRule& rule);

}  // namespace coppice
