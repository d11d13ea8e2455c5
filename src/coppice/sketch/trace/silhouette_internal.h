#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include "coppice/base/context.h"
#include "coppice/sketch/sketch.h"
#include "coppice/sketch/trace/mask.h"

namespace coppice::sketch_internal {

/// Returns per pixel the exact distance [pixels] of its centre from the closest pixel outside. O(pixels).
std::vector<float> distance_to_outside(const Mask& mask);
/// Returns per pixel the exact distance [pixels] of its centre from the closest pixel inside; very large if
/// there is no such pixel. O(pixels).
std::vector<float> distance_to_inside(const Mask& mask);

/// Thins the mask to lines of one pixel near its medial axis, with the same connectivity (Zhang and Suen).
/// O(pixels of the mask times half its width).
Mask thinned(Mask mask, const Context& ctx);

/// Returns the largest connected component of the mask.
Mask largest_part(const Mask& mask);

/// A section of a line between two places where lines meet or end.
struct Edge {
    std::array<std::uint32_t, 2> nodes{};  ///< at its front and back
    std::vector<PicturePoint> points;      ///< pixel centres from the first node to the second
};

/// A place where lines meet or end.
struct MeetingPlace {
    PicturePoint place;
    double radius = 0;                 ///< [pixels] radius of the mask there
    std::vector<std::uint32_t> edges;  ///< edges that begin or end here
};

/// Graph of the lines of a thinned mask.
struct LineGraph {
    std::vector<MeetingPlace> places;
    std::vector<Edge> edges;
};

/// Converts lines to a graph. Lines that end within the width of the mask at their fork are removed, and
/// places within each other's width are merged, so that crossing branches meet in one place. O(pixels).
LineGraph build_graph(const Mask& lines, const std::vector<float>& distance);

/// A section of a line, directed away from the base.
struct TracedSection {
    std::vector<PicturePoint> points;     ///< [pixels] at least two
    double radius = 0;                    ///< [pixels] radius of the place where it begins
    std::optional<std::uint32_t> before;  ///< the section that it continues, which has a smaller index
    bool is_tip = false;                  ///< whether it ends where no other line does
};

/// Returns the sections of lines that are connected to the lowest place. Where lines meet, each is entered
/// from the one with the smallest turn, so that crossing branches pass each other. O(edges log edges).
std::vector<TracedSection> find_paths(const LineGraph& graph, const Mask& mask,
                                      const std::vector<float>& distance);

/// Converts consecutive sections to a smooth stroke with a point every 8 pixels. A stroke that begins at the
/// base extends to the ground; one that leaves another has its own width from its start.
Stroke stroke_along(std::span<const TracedSection> sections, std::span<const std::uint32_t> chain,
                    const Mask& mask, const std::vector<float>& distance);

}  // namespace coppice::sketch_internal
