#pragma once

#include <span>
#include <string>
#include <vector>

#include "coppice/base/context.h"
#include "coppice/sketch/sketch.h"
#include "coppice/sketch/trace/mask.h"

namespace coppice {

/// A sketch traced from silhouettes.
struct TraceResult {
    Sketch sketch;  ///< branches that were found, with strokes in all views
    std::vector<std::uint32_t>
        tips;  ///< number of tips visible in each of two views; with more views, in space
};

/// Returns the stroke from the centre of the lowest pixels of a silhouette to its highest one, which
/// determines the camera of a snapshot. Throws InvalidInput, beginning with `where`, if the silhouette is
/// empty. O(pixels).
Stroke compute_extent(const Mask& silhouette, const std::string& where);

/// Traces a sketch of a tree from its silhouettes in at least two views, as a start for manual corrections.
///
/// With two views, every silhouette is thinned to its medial axis. Its lines, from the lowest end, continue
/// in the straightest direction where they meet; their widths are those of the silhouette. Strokes of both
/// views that leave the same place of an existing branch and match as in `reconstruct` form a branch; the
/// best pairs come first, beginning with stems. Hidden branches are not found: in dense crowns many branches
/// are missing and some are wrong.
///
/// With three or more views, the visual hull is computed [Laurentini1994]. Paths along the centres of its
/// widest sections lead from its base to all protruding ends [Sato2000]; of these, longest first, paths are
/// kept that cover pixels in two views which no other path covers. Cameras must be accurate to one or two
/// pixels: a part that is missing in one silhouette is missing in the result.
///
/// With two views O(pixels of the silhouettes times half their width, and pairs of strokes); otherwise O(c
/// log c) for c cells of about a pixel, at most a million, and at worst O(pixels) for each end. Throws
/// InvalidInput for fewer than two views, for a silhouette that is empty or does not have the size of its
/// view, and if no stem is found; Cancelled.
TraceResult trace(const std::vector<SketchView>& views, std::span<const Mask> silhouettes,
                  const Context& ctx = {});

}  // namespace coppice
