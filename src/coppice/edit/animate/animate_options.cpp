#include "coppice/edit/animate/animate_options.h"

#include "coppice/base/option_fields.h"

namespace coppice {

void list_fields(AnimateOptions& o, FieldList& list) {
    list.add(
        common_field("duration", "Duration in seconds; 0 uses the duration of the keys, or 4 without keys.",
                     Unit::none, 0, 3600),
        o.duration);
    list.add(common_field("rate", "Number of frames per second.", Unit::none, 1, 240), o.rate);
    list.add(Field{"gif_colors", "Maximum number of colours of a GIF; fewer colours make smaller files.",
                   Unit::none, 2, 255},
             o.gif_colors);
}

}  // namespace coppice
