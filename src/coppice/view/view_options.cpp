#include "coppice/view/view_options.h"

#include "coppice/base/option_fields.h"

namespace coppice {

void list_fields(ViewOptions& o, FieldList& list) {
    list_fields(o.camera, list);
    list.add(Field{"smoothing",
                   "Number of samples per pixel along edges, limited by the device; 1 disables antialiasing.",
                   Unit::none, 1, 16},
             o.smoothing);
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
