#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "coppice/base/context.h"
#include "coppice/base/vec.h"
#include "coppice/extract/points/graph_internal.h"
#include "coppice/extract/points/neighbours_internal.h"

namespace coppice::extract_internal {

/// Returns the shortest links that join components closer than `limit` [m], as in a minimum spanning tree:
/// Boruvka's rounds over a hierarchy of boxes. O(n log n) per round.
std::vector<Link> bridge_gaps(std::span<const Vec3> points, std::span<const std::uint8_t> ignored,
                              const Components& parts, double limit, const Context& ctx);

/// Maximum widths of bridged gaps.
struct GapRule {
    double usual = 0;   ///< [m] between any components
    double widest = 0;  ///< [m] between large components, up to a third of their extent
};

/// Graph of the points and their neighbours, with gaps between components bridged by the shortest links and
/// by links between the closest representative points of increasing voxels, from which paths select. A link
/// between two ends of limbs that continue each other costs three times as much as a path of the same length
/// over points.
struct ConnectedGraph {
    Graph graph;
    Components components;
    std::vector<Link> bridges;  ///< shortest links across usual gaps
    std::uint32_t wide = 0;     ///< number of bridged gaps that are wider than usual
};
ConnectedGraph connect_points(std::span<const Vec3> points, const Neighbours& neighbours,
                              std::span<const std::uint8_t> ignored, const GapRule& gap, const Context& ctx);

}  // namespace coppice::extract_internal
