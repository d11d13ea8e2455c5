#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "coppice/skeleton/skeleton.h"

/// Measures of branching architecture, in the terms used to compare trees, roots and neurons.
namespace coppice {

/// Returns the order of the axis of each node: 0 for a root; at a fork the thickest child continues its
/// parent's axis, and every other child begins an axis of the next order. O(n).
std::vector<std::uint32_t> axis_orders(const Skeleton& skeleton);

/// Totals of the axes of one order.
struct BranchOrder {
    std::uint64_t branches = 0;  ///< number of axes
    double length = 0;           ///< [m] total length
    double volume = 0;           ///< [m^3] total volume of the cones between nodes
};

/// Returns the totals of each order of `axis_orders`. O(n).
std::vector<BranchOrder> branch_orders(const Skeleton& skeleton);

/// Returns the totals for given orders and axes, each with a number for each node; orders are less than the
/// number of nodes, and an axis begins where its number or its order differs from that of the parent. O(n).
std::vector<BranchOrder> branch_orders(const Skeleton& skeleton, std::span<const std::uint32_t> order,
                                       std::span<const std::uint32_t> axis);

/// Returns the order of each node after [Strahler1957]: 1 for a tip; otherwise the maximum of its children,
/// plus one if two children have it. O(n).
std::vector<std::uint32_t> strahler_orders(const Skeleton& skeleton);

/// Totals of the segments in a class of diameters.
struct DiameterClass {
    double from = 0;    ///< [m] minimum diameter, inclusive
    double to = 0;      ///< [m] maximum diameter, exclusive; infinite for the last class
    double length = 0;  ///< [m] of segments, or parts of them, in the class
    double area = 0;    ///< [m^2] lateral area of their cones
    double volume = 0;  ///< [m^3] of their cones
};

/// Returns the classes of diameter between 0, the limits [m], and infinity: one more than there are limits.
/// Segments that taper across a limit are split there. Throws InvalidInput for limits that are not positive,
/// finite and increasing. O(n log k) for k classes, plus the parts of segments, at most k for each.
std::vector<DiameterClass> diameter_classes(const Skeleton& skeleton, std::span<const double> limits);

/// Number of crossings of branches with spheres about their roots [Sholl1953].
struct ShollProfile {
    double step = 0;                       ///< [m] distance between the radii of the spheres
    std::vector<std::uint64_t> crossings;  ///< with the spheres of radius step, 2 step, ...

    /// Returns the radius in metres of the sphere with the maximum number of crossings, the smallest on ties;
    /// 0 if there are no crossings.
    double critical_radius() const;
    /// Returns the maximum number of crossings.
    std::uint64_t most() const;
};

/// Counts the crossings of the axes of each tree with spheres about its root, summed over all trees. Segments
/// that touch a sphere from outside and turn back do not cross it, those that enter and leave it cross twice.
/// `step` 0 means a hundredth of the reach. Throws InvalidInput for a step that is negative, not finite, or
/// so small that there would be over a million spheres. O(n + spheres).
ShollProfile sholl(const Skeleton& skeleton, double step = 0);

}  // namespace coppice
