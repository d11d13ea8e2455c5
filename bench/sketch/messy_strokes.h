#pragma once

#include <cstdint>

#include "coppice/sketch/sketch.h"

namespace coppice::bench {

/// Errors of hand-drawn strokes.
struct Mess {
    double jitter = 0;  ///< [pixels] maximum displacement of every point, horizontally and vertically
    /// share of all strokes in which one view omits 5 to 20 % of the length at the start or tip
    double cut = 0;
    double wrong = 0;    ///< share of all points that are 20 to 60 pixels off
    bool known = false;  ///< whether the wrong points are known and removed
};

/// Returns the sketch with these errors. The same seed produces the same sketch.
Sketch messed_up(Sketch sketch, const Mess& mess, std::uint64_t seed);

/// Rotates a camera by `degrees` around a random axis through the tree's base, the origin, and scales its
/// images by as many per cent. The same seed produces the same axis.
void misplace(SketchView& view, double error, std::uint64_t seed);

}  // namespace coppice::bench
