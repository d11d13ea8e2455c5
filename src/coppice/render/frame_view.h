#pragma once

#include <span>

#include "coppice/render/render.h"
#include "coppice/sketch/view.h"

namespace coppice {

/// Returns the camera that render() would use for these points [m], for other renderers: its direction is
/// that of the options, and all points fit into the image. Throws InvalidInput without points, for a point
/// that is not finite, and if their box has no extent. O(n).
SketchView frame_view(std::span<const Vec3d> points, const RenderOptions& options);

}  // namespace coppice
