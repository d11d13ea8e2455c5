#pragma once

#include <span>
#include <vector>

#include "coppice/base/context.h"
#include "coppice/sketch/line_internal.h"

namespace coppice::sketch_internal {

/// Moves all cameras but the first by little, so that the starts and tips of all branches, which every view
/// shows, lie on each other's lines of sight: each turns by about a degree, moves by about a hundredth of how
/// far off it is, and takes pictures about a hundredth larger or smaller, or by less; what strokes say
/// nothing of stays as it is. Points that are wrong lose their weight. Gauss-Newton; O(branches) for every
/// view.
void refine_cameras(const Sketch& sketch, std::span<SketchView> views, const Hand& hand, const Context& ctx);

}  // namespace coppice::sketch_internal
