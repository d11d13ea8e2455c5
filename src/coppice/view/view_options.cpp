#include "coppice/view/view_options.h"

#include "coppice/base/option_fields.h"

namespace coppice {

void list_fields(ViewOptions& o, FieldList& list) {
    list.add(common_field("width", "Width of the image in pixels.", Unit::none, 16, 16384), o.width);
    list.add(common_field("height", "Height of the image in pixels.", Unit::none, 16, 16384), o.height);
    list.add(Field{"smoothing",
                   "Number of samples per pixel along edges, limited by the device; 1 disables antialiasing.",
                   Unit::none, 1, 16},
             o.smoothing);
    list.add(common_field("azimuth", "Direction of the camera, counter-clockwise from +x seen from above.",
                          Unit::radian, -6.2832, 6.2832),
             o.azimuth);
    list.add(
        common_field("elevation", "Height of the camera above the horizon.", Unit::radian, -1.5708, 1.5708),
        o.elevation);
    list.add(Field{"field_of_view", "Field of view of the camera across the longer side of the image.",
                   Unit::radian, 0.01, 2.5},
             o.field_of_view);
    list.add(Field{"margin", "Fraction of the image that remains free on each side.", Unit::none, 0, 0.45},
             o.margin);
}

void list_fields(EditDemoOptions& o, FieldList& list) {
    list.add(
        common_field("frames", "Number of frames drawn while the branch is dragged.", Unit::none, 1, 1000000),
        o.frames);
    list.add(
        common_field("segments", "Approximate number of segments of the dragged branch.", Unit::none, 1, 1e9),
        o.segments);
    list.add(
        Field{"swing", "Maximum angle of the dragged branch to both sides of rest.", Unit::radian, 0, 1.5708},
        o.swing);
}

}  // namespace coppice
