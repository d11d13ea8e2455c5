#pragma once

#include "coppice/base/fields.h"

namespace coppice {

/// Duration and frame rate of an animation.
struct AnimateOptions {
    /// [s] total duration; 0 = the duration of the keys, or 4 without keys; in [0, 3600]
    float duration = 0;
    float rate = 24;       ///< [1/s] frame rate; in [1, 240]
    int gif_colors = 255;  ///< maximum number of colours of a GIF; in [2, 255]
};

template <class Self, class Visitor>
requires SameOptions<Self, AnimateOptions>
constexpr void visit_fields(Self& o, Visitor&& visit) {
    visit(common_field("duration", "Duration in seconds; 0 uses the duration of the keys, or 4 without keys.",
                       Unit::none, 0, 3600),
          o.duration);
    visit(common_field("rate", "Number of frames per second.", Unit::none, 1, 240), o.rate);
    visit(Field{"gif_colors", "Maximum number of colours of a GIF; fewer colours make smaller files.",
                Unit::none, 2, 255},
          o.gif_colors);
}

}  // namespace coppice
