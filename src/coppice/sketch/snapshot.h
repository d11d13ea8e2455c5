#pragma once

#include "coppice/sketch/sketch.h"

namespace coppice {

/// An image of a tree by an unknown camera, taken horizontally from one side.
struct Snapshot {
    DrawingSide side = DrawingSide::front;  ///< any side except top
    double field_of_view = 0;               ///< [rad] across the longer side of the image; 0 = orthographic
};

/// Estimates the camera of a snapshot from its strokes and the height [m] of the tree from the base of its
/// first stem to its highest point: the base is at (0, 0, 0), and the highest point has the same depth as the
/// base. If the tree leans towards the camera or away from it, the relative error is the lean divided by the
/// distance of the camera.
///
/// `view` is the index of the view in the sketch, which must have a width and height if there is a field of
/// view; name, image, width and height are kept. Throws InvalidInput, beginning with `where`, if they are
/// missing, if no stem has a stroke in the view, or if no point is above the base. O(points).
SketchView snapshot_view(const Sketch& sketch, std::uint32_t view, const Snapshot& snapshot, double height,
                         const std::string& where);

}  // namespace coppice
