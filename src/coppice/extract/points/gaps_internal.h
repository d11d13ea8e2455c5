#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "coppice/base/context.h"
#include "coppice/base/vec.h"
#include "coppice/extract/points/graph_internal.h"
#include "coppice/extract/points/neighbours_internal.h"

namespace coppice::extract_internal {

/// The shortest links that join what lies nearer together than `limit` [m] into one component, as a minimal
/// spanning tree does: Boruvka's rounds over a hierarchy of boxes. O(n log n) per round.
std::vector<Link> bridge_gaps(std::span<const Vec3> points, std::span<const std::uint8_t> ignored,
                              const Components& parts, double limit, const Context& ctx);

/// Gaps that are bridged.
struct GapRule {
    double usual = 0;   ///< [m] between anything
    double widest = 0;  ///< [m] between large components, as far as a third of their extent
};

/// The points joined to their neighbours, with gaps between components bridged by the shortest links, and by
/// those between the closest of ever larger voxels: paths choose among them. Where the ends of two limbs lead
/// on to each other, a link counts as three times the way that points would have shown.
struct ConnectedGraph {
    Graph graph;
    Components components;
    std::vector<Link> bridges;  ///< the shortest ones over the usual gaps
    std::uint32_t wide = 0;     ///< gaps wider than usual that were bridged
};
ConnectedGraph connect_points(std::span<const Vec3> points, const Neighbours& neighbours,
                              std::span<const std::uint8_t> ignored, const GapRule& gap, const Context& ctx);

}  // namespace coppice::extract_internal
