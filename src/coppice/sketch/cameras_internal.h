#pragma once

#include <span>
#include <vector>

#include "coppice/base/context.h"
#include "coppice/sketch/line_internal.h"

namespace coppice::sketch_internal {

/// Adjusts all cameras except the first, so that the starts and tips of all branches, which every view shows,
/// are on each other's lines of sight. The standard deviations of the changes are about a degree of rotation,
/// a hundredth of the distance and a hundredth of the scale; parameters without evidence in the strokes are
/// unchanged. Outliers lose their weight. Gauss-Newton; O(branches) per view.
void refine_cameras(const Sketch& sketch, std::span<SketchView> views, const Hand& hand, const Context& ctx);

}  // namespace coppice::sketch_internal
