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

template <class Self, class Visitor>
requires SameOptions<Self, ViewOptions>
constexpr void visit_fields(Self& o, Visitor&& visit) {
    visit(common_field("width", "Width of the image in pixels.", Unit::none, 16, 16384), o.width);
    visit(common_field("height", "Height of the image in pixels.", Unit::none, 16, 16384), o.height);
    visit(Field{"smoothing",
                "Number of samples per pixel along edges, limited by the device; 1 disables antialiasing.",
                Unit::none, 1, 16},
          o.smoothing);
    visit(common_field("azimuth", "Direction of the camera, counter-clockwise from +x seen from above.",
                       Unit::radian, -6.2832, 6.2832),
          o.azimuth);
    visit(common_field("elevation", "Height of the camera above the horizon.", Unit::radian, -1.5708, 1.5708),
          o.elevation);
    visit(Field{"field_of_view", "Field of view of the camera across the longer side of the image.",
                Unit::radian, 0.01, 2.5},
          o.field_of_view);
    visit(Field{"margin", "Fraction of the image that remains free on each side.", Unit::none, 0, 0.45},
          o.margin);
}

/// Options of the demo that drags a branch back and forth and measures the time.
struct EditDemoOptions {
    int frames = 240;      ///< number of drawn frames
    int segments = 500;    ///< approximate size of the branch: see branch_of_about
    float swing = 0.349f;  ///< [rad] maximum angle to both sides of rest
};

template <class Self, class Visitor>
requires SameOptions<Self, EditDemoOptions>
constexpr void visit_fields(Self& o, Visitor&& visit) {
    visit(
        common_field("frames", "Number of frames drawn while the branch is dragged.", Unit::none, 1, 1000000),
        o.frames);
    visit(
        common_field("segments", "Approximate number of segments of the dragged branch.", Unit::none, 1, 1e9),
        o.segments);
    visit(
        Field{"swing", "Maximum angle of the dragged branch to both sides of rest.", Unit::radian, 0, 1.5708},
        o.swing);
}

}  // namespace coppice
