#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "coppice/extract/points/graph_internal.h"
#include "coppice/extract/tree/draft_tree.h"

namespace coppice::extract_internal {

/// The points that branches are traced through, one after the other.
struct BranchPoints {
    std::span<const Vec3> position;  ///< [m]
    const Graph& graph;
    std::span<const float> spacing;       ///< [m]
    std::span<const std::uint32_t> node;  ///< of each point, kNone for free ones
    double step;                          ///< [spacing] between nodes
    bool narrow = false;                  ///< branches follow their paths, however far their points spread
    /// Per point the last round that looked at it, so that no round has to clear what another one left.
    std::vector<std::uint32_t> seen = std::vector<std::uint32_t>(position.size(), 0);
    std::uint32_t round = 0;
};

/// A point of a branch.
struct BranchPoint {
    std::uint32_t point;
    double t;        ///< where on the line it is: index + fraction
    double squared;  ///< [m^2] distance from the line
};

/// One branch: a path over the points of its surface, which becomes a line through its middle.
struct Centerline {
    std::vector<std::uint32_t> path;   ///< free points, from the base outward
    std::vector<Vec3d> line;           ///< [m] first from the point that the path ends at, then through it
    std::vector<BranchPoint> members;  ///< the points of the branch; after `fit_centerline`
    double spacing = 0;                ///< [m] mean on the path
    double radius = 0;                 ///< [m] mean distance of the members; after `fit_centerline`
};

/// Takes the path of free points from `start` to the first point that has a node, and returns that point.
/// `start` may have a node itself: then the path is empty.
std::uint32_t trace_path(Centerline& branch, const BranchPoints& points, std::uint32_t start,
                         const Paths& paths);

/// [m] of the line.
double line_length(const Centerline& branch);

/// Gathers the free points of the branch about its path, which must not be empty, as wide as it takes, and
/// moves the line to their middle: lines fitted to those near each of its nodes. `thickest` [m] is the radius
/// of what it leaves.
void fit_centerline(Centerline& branch, BranchPoints& points, double thickest);

/// The free points within `reach` [m] of the line that are connected to its path.
std::vector<BranchPoint> points_about(const Centerline& branch, BranchPoints& points, double reach);

/// Adds the line as children of `owner`, and says of its points that they are its own. Returns the last node.
std::uint32_t add_branch(const Centerline& branch, DraftTree& tree, std::vector<std::uint32_t>& node,
                         std::uint32_t owner);

}  // namespace coppice::extract_internal
