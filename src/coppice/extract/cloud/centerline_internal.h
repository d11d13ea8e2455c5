#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "coppice/base/id.h"
#include "coppice/extract/points/graph_internal.h"
#include "coppice/extract/tree/initial_tree_internal.h"

namespace coppice::extract_internal {

/// Points through which branches are traced, one after the other.
struct BranchPoints {
    std::span<const Vec3> position;  ///< [m]
    const Graph& graph;
    std::span<const float> spacing;       ///< [m]
    std::span<const std::uint32_t> node;  ///< node of each point, kNoIndex for free points
    double step;                          ///< [spacing] distance between nodes
    bool narrow = false;  ///< whether branches follow their paths regardless of the scatter of their points
    /// Last round that visited each point; rounds need not clear it.
    std::vector<std::uint32_t> seen = std::vector<std::uint32_t>(position.size(), 0);
    std::uint32_t round = 0;
};

/// Point of a branch.
struct BranchPoint {
    std::uint32_t point;
    double t;        ///< position on the line: index + fraction
    double squared;  ///< [m^2] distance from the line
};

/// Branch: a path over points of its surface, converted to a line through its middle.
struct Centerline {
    std::vector<std::uint32_t> path;  ///< free points, from the base outward
    std::vector<Vec3d>
        line;  ///< [m] initially along the path, from the point at its end; later the centreline
    std::vector<BranchPoint> members;  ///< points of the branch; set by `fit_centerline`
    double spacing = 0;                ///< [m] mean spacing of the path
    double radius = 0;                 ///< [m] mean distance of the members; set by `fit_centerline`
};

/// Stores the path of free points from `start` to the first point with a node, and returns that point. If
/// `start` has a node, the path is empty.
std::uint32_t trace_path(Centerline& branch, const BranchPoints& points, std::uint32_t start,
                         const Paths& paths);

/// Returns the length [m] of the line.
double line_length(const Centerline& branch);

/// Gathers the free points of the branch about its path, which must not be empty, with an increasing reach,
/// and moves the line to their middle: to lines fitted to the points near each of its nodes. `thickest` [m]
/// is the radius of the parent branch.
void fit_centerline(Centerline& branch, BranchPoints& points, double thickest);

/// Returns the free points within `reach` [m] of the line that are connected to its path.
std::vector<BranchPoint> points_about(const Centerline& branch, BranchPoints& points, double reach);

/// Adds the line as descendants of `owner` and assigns its points to the new nodes. Returns the last node.
std::uint32_t add_branch(const Centerline& branch, InitialTree& tree, std::vector<std::uint32_t>& node,
                         std::uint32_t owner);

}  // namespace coppice::extract_internal
