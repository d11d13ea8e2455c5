#pragma once

#include <cstdint>

#include "coppice/sketch/sketch.h"

namespace coppice::bench {

/// What goes wrong when people draw.
struct Mess {
    double jitter = 0;   ///< [pixels] every point strays by as much at most, across and down
    double cut = 0;      ///< of all strokes: one view's misses 5 to 20 % of its length at its start or tip
    double wrong = 0;    ///< of all points: they lie 20 to 60 pixels off
    bool known = false;  ///< somebody who knows which points are wrong has taken them out
};

/// The sketch, drawn worse. The same seed gives the same sketch.
Sketch messed_up(Sketch sketch, const Mess& mess, std::uint64_t seed);

/// Turns a camera by so many degrees about some axis through the tree's foot, the origin, and scales its
/// pictures by as many per cent. The same seed gives the same axis.
void misplace(SketchView& view, double error, std::uint64_t seed);

}  // namespace coppice::bench
