#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "coppice/extract/prior/evidence_internal.h"
#include "coppice/extract/tree/draft_tree.h"

namespace coppice::extract_internal {

/// How thick the branches of a forest are for what hangs on them: the radius falls from that of the foot with
/// a power of the share of the tree's wood, by length, that is beyond, as in [Xu2007].
struct Allometry {
    std::vector<double> log_share;  ///< per node: logarithm of the share
    std::vector<double> log_foot;   ///< per node: logarithm of the radius of its tree's foot [m]
    double exponent = 0;

    double log_radius(std::uint32_t n) const { return log_foot[n] + exponent * log_share[n]; }
};

/// The foot is what its points say, and else what trees of that height have. The exponent is that of most
/// trees, unless most of the wood of some thickness shows another one: wood too thin to be seen counts as
/// thinner than what is seen, so that what sticks out of it says little. O(n log n).
Allometry fit_allometry(const DraftTree& tree, std::span<const NodeEvidence> evidence);

/// The radius of every node with its uncertainty, and how much of it was measured.
struct RadiusBelief {
    std::vector<double> low, high;  ///< [m] nine of ten lie between
    std::vector<double> measured;   ///< share of the measure against the prior, in [0, 1]
    std::vector<char> limited;      ///< whether the stem could not bear what was measured
};

/// Gives every node the most likely radius: what its points say, by their precision, with what trees are like
/// elsewhere: as thick as what hangs on them wants, and never thicker than what bears them. Points that would
/// make a branch far thicker than that are leaves or several twigs, and count little. On measured stems all
/// branches as far from the root have together at most `area_limit` times the cross-section of the lowest
/// eighth of the tree, as pipes would [Shinozaki1964]; 0 = no limit. O(n log n).
RadiusBelief believe_radii(DraftTree& tree, std::span<const NodeEvidence> evidence, double area_limit);

}  // namespace coppice::extract_internal
