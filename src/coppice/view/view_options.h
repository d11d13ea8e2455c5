#pragma once

#include "coppice/base/fields.h"
#include "coppice/render/frame_view.h"

namespace coppice {

/// Options of drawing a surface by OpenGL.
struct ViewOptions {
    CameraOptions camera{.width = 1920, .height = 1080};  ///< listed without a group
    int smoothing = 4;  ///< samples per pixel along edges; 1 = none; limited by the device
};

/// Lists the members for front ends.
void list_fields(ViewOptions& o, FieldList& list);

}  // namespace coppice
