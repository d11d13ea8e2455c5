#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "coppice/extract/prior/evidence_internal.h"
#include "coppice/extract/tree/initial_tree_internal.h"

namespace coppice::extract_internal {

/// Relation between the radius of a branch and the branches that it supports: the radius decreases from that
/// at the base with a power of the share of the tree beyond, by length, as in [Xu2007].
struct Allometry {
    std::vector<double> log_share;        ///< per node: logarithm of the share
    std::vector<double> log_base_radius;  ///< per node: logarithm of the radius [m] at the base of its tree
    double exponent = 0;

    double log_radius(std::uint32_t n) const { return log_base_radius[n] + exponent * log_share[n]; }
};

/// Estimates the radius at the base from its points, or without points from the height of the tree. The
/// exponent is the usual one of trees, unless most of the branches in a class of thickness show another one:
/// branches too thin to be measured count as thinner than the measured ones, so that these alone have little
/// influence. O(n log n).
Allometry fit_allometry(const InitialTree& tree, std::span<const NodeEvidence> evidence);

/// Estimated radius of every node with its uncertainty, and the share of it that was measured.
struct RadiusEstimate {
    std::vector<double> low, high;  ///< [m] 90 % interval
    std::vector<double> measured;   ///< weight of the measurement against the prior, in [0, 1]
    std::vector<char> limited;      ///< whether the stem could not support the measured radius
};

/// Sets every radius to the most likely value: the estimate from its points, weighted by its precision,
/// combined with the prior of trees; the radius never increases from a node to its children. Points that
/// would make a branch far thicker than the prior are leaves or several twigs, and have little weight. On
/// measured stems all branches at the same distance from the root have in total at most `area_limit` times
/// the cross-section of the lowest eighth of the tree, as in the pipe model [Shinozaki1964]; 0 = no limit.
/// O(n log n).
RadiusEstimate believe_radii(InitialTree& tree, std::span<const NodeEvidence> evidence, double area_limit);

}  // namespace coppice::extract_internal
