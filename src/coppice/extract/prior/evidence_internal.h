#pragma once

#include <span>
#include <vector>

#include "coppice/base/context.h"
#include "coppice/extract/tree/capsule_fit_internal.h"
#include "coppice/extract/tree/initial_tree_internal.h"

namespace coppice::extract_internal {

/// Returns the distance [m] from a surface at which points with this standard deviation [m] may still be
/// there by chance, because of bark, needles or noise; 0 if there are too few points.
inline double compute_margin(double points, double scatter) {
    // Points at a larger distance are not among those that determine the scatter: add half of it.
    constexpr double kScatters = 3 * 1.5, kEnough = 12;
    return points > kEnough ? kScatters * scatter : 0;
}

/// Estimates from the points around a node and from those of its neighbours on the axis.
struct NodeEvidence {
    double own = 0;      ///< number of points, each shared between the two nodes of its segment
    double points = 0;   ///< the same number for the node and its neighbours
    double radius = 0;   ///< [m] estimate from these points; 0 without points
    double scatter = 0;  ///< [m] standard deviation of their distance from the surface
    double spacing = 0;  ///< [m] mean spacing of the points; that of the parent without points
    bool fixed = false;  ///< whether the radius was measured before and is certain

    /// Returns how much the points fill the branch instead of its surface, in [0, 1]: on a tube their scatter
    /// is small relative to the radius, in a filled disc it is 0.35 of the mean distance.
    double filled() const;
    /// Returns the inverse variance of the logarithm of the radius.
    double precision() const;
    /// Returns the distance [m] from the surface at which a point may be by chance; see `compute_margin`.
    double margin() const { return compute_margin(points, scatter); }
};

/// Computes the evidence of every node from the samples of its segments. O(samples + nodes).
std::vector<NodeEvidence> gather_evidence(const InitialTree& tree, const FitSamples& samples,
                                          std::span<const float> spacing, const Context& ctx);

}  // namespace coppice::extract_internal
