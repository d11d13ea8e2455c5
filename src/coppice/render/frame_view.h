#pragma once

#include <span>

#include "coppice/base/fields.h"
#include "coppice/base/vec.h"
#include "coppice/sketch/view.h"

namespace coppice {

/// Options of an image and of its camera, which is placed so that the whole object just fits into the image.
struct CameraOptions {
    int width = 1024;            ///< [pixels]
    int height = 1024;           ///< [pixels]
    float azimuth = -1.0f;       ///< [rad] from the object to the camera, counter-clockwise from +x
    float elevation = 0.2f;      ///< [rad] of the camera above the horizon
    float field_of_view = 0.5f;  ///< [rad] across the longer side of the image
    float margin = 0.04f;        ///< fraction of the image that remains free on each side
};

/// Lists the members for front ends.
void list_fields(CameraOptions& o, FieldList& list);

/// Returns the camera that render() would use for these points [m], for other renderers: its direction is
/// that of the options, and all points fit into the image. Throws InvalidInput without points, for a point
/// that is not finite, and if their box has no extent. O(n).
SketchView frame_view(std::span<const Vec3d> points, const CameraOptions& options);

}  // namespace coppice
