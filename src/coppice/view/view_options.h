#pragma once

#include "coppice/base/fields.h"

namespace coppice {

/// How a surface is drawn by OpenGL. The camera stands where the whole of it just fills the picture.
struct ViewOptions {
    int width = 1920;        ///< [pixels]
    int height = 1080;       ///< [pixels]
    int smoothing = 4;       ///< samples per pixel along edges; 1 = none; fewer where there are not as many
    float azimuth = -1.0f;   ///< [rad] from the object to the camera, counter-clockwise from +x
    float elevation = 0.2f;  ///< [rad] of the camera above the horizon
    float field_of_view = 0.5f;  ///< [rad] across the longer side of the picture
    float margin = 0.04f;        ///< of the picture left free on each side
};

template <class Self, class Visitor>
requires SameOptions<Self, ViewOptions>
constexpr void visit_fields(Self& o, Visitor&& visit) {
    visit(common_field("width", "Width of the picture in pixels", Unit::none, 16, 16384), o.width);
    visit(common_field("height", "Height of the picture in pixels", Unit::none, 16, 16384), o.height);
    visit(Field{"smoothing", "samples per pixel along edges, as far as the device has them; 1 = none",
                Unit::none, 1, 16},
          o.smoothing);
    visit(common_field("azimuth", "Direction of the camera, counter-clockwise from +x seen from above",
                       Unit::radian, -6.2832, 6.2832),
          o.azimuth);
    visit(common_field("elevation", "Height of the camera above the horizon", Unit::radian, -1.5708, 1.5708),
          o.elevation);
    visit(Field{"field_of_view", "opening of the camera across the longer side", Unit::radian, 0.01, 2.5},
          o.field_of_view);
    visit(Field{"margin", "part of the picture left free on each side", Unit::none, 0, 0.45}, o.margin);
}

/// A branch that is dragged to and fro, for its times.
struct EditDemoOptions {
    int frames = 240;      ///< that are drawn
    int segments = 500;    ///< of the branch, about: see branch_of_about
    float swing = 0.349f;  ///< [rad] greatest angle to both sides of rest
};

template <class Self, class Visitor>
requires SameOptions<Self, EditDemoOptions>
constexpr void visit_fields(Self& o, Visitor&& visit) {
    visit(
        common_field("frames", "Number of frames drawn while the branch is dragged", Unit::none, 1, 1000000),
        o.frames);
    visit(common_field("segments", "Approximate number of segments of the branch that is dragged", Unit::none,
                       1, 1e9),
          o.segments);
    visit(Field{"swing", "how far the branch is dragged to both sides", Unit::radian, 0, 1.5708}, o.swing);
}

}  // namespace coppice
