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

}  // namespace coppice
