#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "coppice/skeleton/skeleton.h"

/// How a skeleton branches, in the terms of those who compare trees, roots and neurons.
namespace coppice {

/// Per node the order of its axis: that of a root is 0; at a fork the thickest child goes on with its
/// parent's axis, and every other begins one of the next order. O(n).
std::vector<std::uint32_t> axis_orders(const Skeleton& skeleton);

/// The axes of one order.
struct BranchOrder {
    std::uint64_t branches = 0;  ///< how many
    double length = 0;           ///< [m] of all of them
    double volume = 0;           ///< [m^3] of the cones between their nodes
};

/// What there is of each order of `axis_orders`. O(n).
std::vector<BranchOrder> branch_orders(const Skeleton& skeleton);

/// The same for orders and axes that are known otherwise. Both have a number for each node; orders are below
/// the number of nodes, and an axis begins where its number or its order differs from that of the parent.
/// O(n).
std::vector<BranchOrder> branch_orders(const Skeleton& skeleton, std::span<const std::uint32_t> order,
                                       std::span<const std::uint32_t> axis);

/// Per node its order after [Strahler1957]: 1 for a tip; of others the greatest of its children's, and one
/// more where two have that. O(n).
std::vector<std::uint32_t> strahler_orders(const Skeleton& skeleton);

/// What there is between two thicknesses.
struct DiameterClass {
    double from = 0;    ///< [m] diameter, included
    double to = 0;      ///< [m] not included; infinite for the last class
    double length = 0;  ///< [m] of segments, or parts of them, as thick as that
    double area = 0;    ///< [m^2] lateral area of their cones
    double volume = 0;  ///< [m^3] of their cones
};

/// Classes of diameter between 0, the limits [m], and infinity: one more than there are limits. Segments that
/// taper over a limit are cut there. Throws InvalidInput for limits that are not above 0, finite and rising.
/// O(n log k) for k classes, and at most as many parts of a segment as it has classes.
std::vector<DiameterClass> diameter_classes(const Skeleton& skeleton, std::span<const double> limits);

/// How often branches cross spheres about their roots [Sholl1953].
struct ShollProfile {
    double step = 0;                       ///< [m] between the radii of the spheres
    std::vector<std::uint64_t> crossings;  ///< of the sphere of radius step, 2 step, ...

    /// [m] Radius of the sphere that is crossed most often, of equals the smallest; 0 where none is.
    double critical_radius() const;
    /// How often that is.
    std::uint64_t most() const;
};

/// Crossings of each tree's axes with spheres about its root; those of all trees are added. Segments that
/// touch a sphere from outside and turn back do not cross it, those that dip into it cross twice. `step` 0
/// takes a hundredth of the reach. Throws InvalidInput for a step that is negative or not finite, or so small
/// that there were over a million spheres. O(n + spheres).
ShollProfile sholl(const Skeleton& skeleton, double step = 0);

}  // namespace coppice
