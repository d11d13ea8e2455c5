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

/// [pixels] per pixel, how far its middle is from the nearest one outside. Exact. O(pixels).
std::vector<float> distance_to_outside(const Mask& mask);
/// [pixels] per pixel, how far its middle is from the nearest one inside; very far where there is none.
/// Exact. O(pixels).
std::vector<float> distance_to_inside(const Mask& mask);

/// The mask thinned to lines of one pixel, about in its middle, that are joined as it is (Zhang and Suen).
/// O(pixels of the mask times half its width).
Mask thinned(Mask mask, const Context& ctx);

/// The largest part of the mask that hangs together.
Mask largest_part(const Mask& mask);

/// A piece of a line between two places where lines meet or end.
struct Edge {
    std::array<std::uint32_t, 2> nodes{};  ///< at its front and its back
    std::vector<PicturePoint> points;      ///< from the first node to the second: pixels' middles
};

/// Where lines meet or end.
struct MeetingPlace {
    PicturePoint place;
    double radius = 0;                 ///< [pixels] of the mask there
    std::vector<std::uint32_t> edges;  ///< that begin or end here
};

/// The lines of a thinned mask.
struct LineGraph {
    std::vector<MeetingPlace> places;
    std::vector<Edge> edges;
};

/// Lines as a graph; those that end within the mask's width where they meet another one are left out, and
/// places within each other's width are one, so that branches that cross meet in one place. O(pixels).
LineGraph graph_of(const Mask& lines, const std::vector<float>& distance);

/// A piece of a line as it is walked from the foot.
struct TracedPiece {
    std::vector<PicturePoint> points;     ///< [pixels] two or more
    double radius = 0;                    ///< [pixels] of the place where it begins
    std::optional<std::uint32_t> before;  ///< the piece that it goes on from, which comes before it
    bool is_tip = false;                  ///< it ends where no other line does
};

/// The pieces of lines that are reached from the lowest place. Where lines meet, each is entered from what it
/// turns least from, so that branches that cross pass each other. O(edges log edges).
std::vector<TracedPiece> pieces_of(const LineGraph& graph, const Mask& mask,
                                   const std::vector<float>& distance);

/// Pieces that follow each other, as somebody would draw them: smooth, with a point every 8 pixels. A stroke
/// that begins at the foot goes down to the ground; one that leaves another has its own width from its start.
Stroke stroke_along(std::span<const TracedPiece> pieces, std::span<const std::uint32_t> chain,
                    const Mask& mask, const std::vector<float>& distance);

}  // namespace coppice::sketch_internal
