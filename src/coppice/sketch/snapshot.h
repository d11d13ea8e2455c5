#pragma once

#include "coppice/sketch/sketch.h"

namespace coppice {

/// A picture of a tree whose camera nobody measured, taken level from one side.
struct Snapshot {
    DrawingSide side = DrawingSide::front;  ///< not top
    double field_of_view = 0;  ///< [rad] across its longer side; 0 = from so far off that it is in one scale
};

/// The camera of a snapshot, from strokes in it and the height [m] of the tree from the foot of its first
/// stem to its highest point: the foot lies at (0, 0, 0) and the highest point as far off as the foot. What
/// leans towards the camera or away makes it err by as much as it leans over how far off the camera is.
///
/// `view` is the index of the sketch's view, whose width and height have to be known for a field of view;
/// name, image, width and height are kept. Throws InvalidInput, beginning with `where`, when they are not,
/// when no stem has a stroke in the view, or nothing in it lies above the foot. O(points).
SketchView snapshot_view(const Sketch& sketch, std::uint32_t view, const Snapshot& snapshot, double height,
                         const std::string& where);

}  // namespace coppice
