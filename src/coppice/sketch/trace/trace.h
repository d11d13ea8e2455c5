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
    Sketch sketch;                    ///< of the branches that were found, with strokes in all views
    std::vector<std::uint32_t> tips;  ///< seen in each of two views; of more, in space
};

/// From the middle of the lowest pixels of a silhouette to its highest one: what tells the camera of a
/// snapshot. Throws InvalidInput, beginning with `where`, when nothing is inside. O(pixels).
Stroke extent_of(const Mask& silhouette, const std::string& where);

/// Proposes a sketch of a tree from its silhouettes in two views or more: a start to be corrected.
///
/// Of two, every silhouette is thinned to its medial axis, whose lines, from the lowest end on, go straight
/// on where they meet; their widths are those of the silhouette. Strokes of both views that leave the same
/// place of a branch that was found, and that match as `reconstruct` matches them, are one branch; the best
/// pairs first, stems first. Whatever lies behind something else is not seen: in crowns that are dense many
/// branches are missed and some are wrong.
///
/// Of three or more, space is carved to what all of them show as tree [Laurentini1994], from whose foot ways
/// along the middle of what is widest lead to all that sticks out [Sato2000]; of these the ones are kept, the
/// longest first, that show in two views what no other one shows. Cameras have to be right to a pixel or two:
/// what one silhouette lacks is gone.
///
/// O(pixels of the silhouettes times half their width, and pairs of strokes) of two; else O(c log c) for c
/// cells of about a pixel, a million at most, and O(pixels) for each end at worst. Throws InvalidInput for
/// less than two views, a silhouette whose size is not the view's or that is empty, and when no stem is
/// found; Cancelled.
TraceResult trace(const std::vector<SketchView>& views, std::span<const Mask> silhouettes,
                  const Context& ctx = {});

}  // namespace coppice
