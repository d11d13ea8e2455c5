#pragma once

#include "coppice/base/fields.h"

namespace coppice {

/// Options of drawing a surface by OpenGL. The camera is placed so that the whole surface just fits into the
/// image.
struct ViewOptions {
    int width = 1920;            ///< [pixels]
    int height = 1080;           ///< [pixels]
    int smoothing = 4;           ///< samples per pixel along edges; 1 = none; limited by the device
    float azimuth = -1.0f;       ///< [rad] from the object to the camera, counter-clockwise from +x
    float elevation = 0.2f;      ///< [rad] of the camera above the horizon
    float field_of_view = 0.5f;  ///< [rad] across the longer side of the image
    float margin = 0.04f;        ///< fraction of the image that remains free on each side
};

/// Lists the members for front ends.
void list_fields(ViewOptions& o, FieldList& list);

/// Options of the demo that drags a branch back and forth and measures the time.
struct EditDemoOptions {
    int frames = 240;      ///< number of drawn frames
    int segments = 500;    ///< approximate size of the branch: see branch_of_about
    float swing = 0.349f;  ///< [rad] maximum angle to both sides of rest
};

/// Lists the members for front ends.
void list_fields(EditDemoOptions& o, FieldList& list);

}  // namespace coppice
