#pragma once

#include <span>
#include <string>
#include <vector>

#include "coppice/base/context.h"
#include "coppice/sketch/sketch.h"
#include "coppice/sketch/trace/mask.h"

namespace coppice {

/// A sketch proposed from silhouettes.
struct TraceResult {
    Sketch sketch;  ///< of the branches that were found in both views
    std::vector<std::uint32_t>
        tips;  ///< seen in each view; the sketch has a branch for each that was found in both
};

/// From the middle of the lowest pixels of a silhouette to its highest one: what tells the camera of a
/// snapshot. Throws InvalidInput, beginning with `where`, when nothing is inside. O(pixels).
Stroke extent_of(const Mask& silhouette, const std::string& where);

/// Proposes a sketch of a tree from its silhouettes in two views: a start to be corrected. Every silhouette
/// is thinned to its medial axis, whose lines, from the lowest end on, go straight on where they meet; their
/// widths are those of the silhouette. Strokes of both views that leave the same place of a branch that was
/// found, and that match as `reconstruct` matches them, are one branch; the best pairs first, stems first.
///
/// Whatever lies behind something else is not seen: in crowns that are dense many branches are missed and
/// some are wrong. O(pixels of the silhouettes times half their width, and pairs of strokes). Throws
/// InvalidInput for other than two views, a silhouette whose size is not the view's, and when no stem is
/// found in both; Cancelled.
TraceResult trace(const std::vector<SketchView>& views, std::span<const Mask> silhouettes,
                  const Context& ctx = {});

}  // namespace coppice
