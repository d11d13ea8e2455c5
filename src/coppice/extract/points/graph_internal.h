#pragma once

#include <cstdint>
#include <limits>
#include <optional>
#include <span>
#include <vector>

#include "coppice/base/column.h"
#include "coppice/base/context.h"
#include "coppice/base/id.h"
#include "coppice/base/vec.h"
#include "coppice/extract/points/neighbours_internal.h"

namespace coppice::extract_internal {

using StemBases = std::span<const std::vector<std::uint32_t>>;  ///< points of the lowest slice of each tree

/// Edge between two points.
struct Link {
    std::uint32_t from, to;
    float length;  ///< [m]
};

/// Undirected graph, as rows that contain both directions.
struct Graph {
    Buffer<std::uint32_t> first;  ///< size + 1 offsets
    Buffer<std::uint32_t> to;
    Buffer<float> length;  ///< [m]

    std::uint32_t size() const { return static_cast<std::uint32_t>(first.size() - 1); }
};

/// Connects every point not marked by `ignored` to its neighbours at a distance of at most `longest` [m], and
/// the ends of `more` links. O(n k).
Graph make_graph(const Neighbours& neighbours, std::span<const std::uint8_t> ignored,
                 std::span<const Link> more, const Context& ctx,
                 double longest = std::numeric_limits<double>::infinity());

struct Components {
    std::vector<std::uint32_t> of;    ///< component of each point
    std::vector<std::uint32_t> size;  ///< number of points of each, in order of their first points
};
Components components(const Graph& graph, const Context& ctx);

/// Returns the components of the graph that `make_graph` would create from the same arguments, without
/// creating it. O(n k).
Components components(const Neighbours& neighbours, std::span<const std::uint8_t> ignored,
                      std::span<const Link> more, const Context& ctx,
                      double longest = std::numeric_limits<double>::infinity());

/// Shortest paths from sources. A link costs the square of its length in spacings, limited to the median
/// spacing: many short steps are preferred to one long jump, which keeps paths on the branches where points
/// are dense; a cost is about a number of points passed.
struct Paths {
    Buffer<std::uint32_t> parent;      ///< per point; kNoIndex for sources and unreached points
    Buffer<float> distance;            ///< cost of the path; infinity for unreached points
    std::vector<std::uint32_t> order;  ///< reached points that are not taken, parents first
};

/// Parameters of the cost of a link.
struct PathCost {
    std::span<const float> spacing;       ///< [m] per point
    std::span<const Vec3> position = {};  ///< per point; empty if turns have no cost
    std::span<const Vec3> outward = {};   ///< unit direction of growth per point; may be empty
};

/// Computes shortest paths from `sources`. Sources may be `taken` points (not kNoIndex there), which paths
/// leave but do not enter. O(n log n).
Paths shortest_paths(const Graph& graph, std::span<const std::uint32_t> sources,
                     std::span<const std::uint32_t> taken, const PathCost& cost, const Context& ctx);

/// Marks the components with enough points for a tree.
std::vector<std::uint8_t> mark_large_parts(const Components& parts);

struct RootOptions {
    double spacing;                   ///< [m] spacing of the points
    std::optional<Vec3d> given = {};  ///< [m] position of the only tree, if set
    int max_trees = 0;                ///< maximum number of trees, thickest first; 0 = all
};

/// Returns for each tree the points of its lowest slice, its stem base. Without a specified position, trees
/// are in each component with enough points at the lowest sections as thick as a trunk.
std::vector<std::vector<std::uint32_t>> find_roots(std::span<const Vec3> points, const Graph& graph,
                                                   const Components& parts, const RootOptions& options,
                                                   const Context& ctx);

}  // namespace coppice::extract_internal
