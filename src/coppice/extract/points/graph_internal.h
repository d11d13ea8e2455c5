#pragma once

#include <cstdint>
#include <limits>
#include <optional>
#include <span>
#include <vector>

#include "coppice/base/column.h"
#include "coppice/base/context.h"
#include "coppice/base/vec.h"
#include "coppice/extract/none_internal.h"
#include "coppice/extract/points/neighbours_internal.h"

namespace coppice::extract_internal {

using StemBases = std::span<const std::vector<std::uint32_t>>;  ///< points of the lowest slice of each tree

/// An edge between two points.
struct Link {
    std::uint32_t from, to;
    float length;  ///< [m]
};

/// Undirected, as rows of both directions.
struct Graph {
    Buffer<std::uint32_t> first;  ///< size + 1 offsets
    Buffer<std::uint32_t> to;
    Buffer<float> length;  ///< [m]

    std::uint32_t size() const { return static_cast<std::uint32_t>(first.size() - 1); }
};

/// Joins every point that `ignored` does not mark to its neighbours up to `longest` [m] away, and the ends of
/// `more` links. O(n k).
Graph make_graph(const Neighbours& neighbours, std::span<const std::uint8_t> ignored,
                 std::span<const Link> more, const Context& ctx,
                 double longest = std::numeric_limits<double>::infinity());

struct Components {
    std::vector<std::uint32_t> of;    ///< of each point
    std::vector<std::uint32_t> size;  ///< points of each, in order of their first points
};
Components components(const Graph& graph, const Context& ctx);

/// Those of the graph that `make_graph` makes of the same, without making it. O(n k).
Components components(const Neighbours& neighbours, std::span<const std::uint8_t> ignored,
                      std::span<const Link> more, const Context& ctx,
                      double longest = std::numeric_limits<double>::infinity());

/// Shortest paths from sources, where a link costs the square of its length in spacings, no more than the
/// median one: many short steps go before one long jump, which keeps paths on the wood where points are
/// dense, and a cost is about a number of points passed.
struct Paths {
    Buffer<std::uint32_t> parent;      ///< of each point; kNone for sources and what is not reached
    Buffer<float> distance;            ///< the cost; infinite for what is not reached
    std::vector<std::uint32_t> order;  ///< the points that are reached and not taken, parents first
};

/// What a link of a path costs.
struct PathCost {
    std::span<const float> spacing;       ///< [m] of each point
    std::span<const Vec3> position = {};  ///< of each point; empty: turns cost nothing
    std::span<const Vec3> outward = {};   ///< per point how branches grow, of length 1; empty: anyhow
};

/// Sources may be points that are `taken` (not kNone there), which paths leave but do not enter. O(n log n).
Paths shortest_paths(const Graph& graph, std::span<const std::uint32_t> sources,
                     std::span<const std::uint32_t> taken, const PathCost& cost, const Context& ctx);

struct RootOptions {
    double spacing;                   ///< [m] of the points
    std::optional<Vec3d> given = {};  ///< [m] there is one tree, and it stands at the point nearest to this
    int most_trees = 0;               ///< the thickest so many; 0 = all
};

/// Where trees stand: for each the points of its lowest slice, its stem base. Without a given place they
/// stand, in each component with enough points, at the lowest places as thick as a trunk.
std::vector<std::vector<std::uint32_t>> find_roots(std::span<const Vec3> points, const Graph& graph,
                                                   const Components& parts, const RootOptions& options,
                                                   const Context& ctx);

}  // namespace coppice::extract_internal
