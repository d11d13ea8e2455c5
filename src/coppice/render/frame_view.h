#pragma once

#include <span>

#include "coppice/render/render.h"
#include "coppice/sketch/view.h"

namespace coppice {

/// The camera with which render() would look at these points [m], for those who draw by other means: it
/// stands where the options say, and they all fit into the picture. Throws InvalidInput without points, and
/// when one is not finite or their box has no size. O(n).
SketchView frame_view(std::span<const Vec3d> points, const RenderOptions& options);

}  // namespace coppice
