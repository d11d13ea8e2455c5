#pragma once

#include <span>
#include <vector>

#include "coppice/base/context.h"
#include "coppice/extract/tree/capsule_fit.h"
#include "coppice/extract/tree/draft_tree.h"

namespace coppice::extract_internal {

/// [m] How far off a surface a point may lie by chance, among bark, needles or noise, when so many points
/// have this standard deviation [m]; 0 where too few tell.
inline double margin_of(double points, double scatter) {
    // Points farther off are not among those that show the scatter: it is half as much again.
    constexpr double kScatters = 3 * 1.5, kEnough = 12;
    return points > kEnough ? kScatters * scatter : 0;
}

/// What the points about a node say of it, with those of its neighbours on the axis.
struct NodeEvidence {
    double own = 0;  ///< points that lie nearer to this node than to the others of their segments, by share
    double points = 0;   ///< the same of it and its neighbours
    double radius = 0;   ///< [m] that suits them best; 0 without any
    double scatter = 0;  ///< [m] standard deviation of their distance from the surface
    double spacing = 0;  ///< [m] mean of them, or else that of the parent
    bool fixed = false;  ///< the radius was measured before, and is certain

    /// How much the points fill the branch instead of lying on its surface, in [0, 1]: those on a tube have a
    /// scatter that is small against the radius, in a filled disc it is 0.35 of the mean distance.
    double filled() const;
    /// Inverse variance of the logarithm of the radius.
    double precision() const;
    /// [m] How far off the surface a point may lie by chance; see `margin_of`.
    double margin() const { return margin_of(points, scatter); }
};

/// The evidence of every node, from the samples that its segments have. O(samples + nodes).
std::vector<NodeEvidence> gather_evidence(const DraftTree& tree, const FitSamples& samples,
                                          std::span<const float> spacing, const Context& ctx);

}  // namespace coppice::extract_internal
