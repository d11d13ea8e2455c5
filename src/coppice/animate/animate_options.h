#pragma once

#include "coppice/base/fields.h"

namespace coppice {

/// How an animation runs.
struct AnimateOptions {
    float duration = 0;    ///< [s] of all frames; 0 = that of its keys, or 4; in [0, 3600]
    float rate = 24;       ///< [1/s] frames; in [1, 240]
    int gif_colors = 255;  ///< of a GIF at most; in [2, 255]
};

template <class Self, class Visitor>
requires SameOptions<Self, AnimateOptions>
constexpr void visit_fields(Self& o, Visitor&& visit) {
    visit(common_field("duration", "Duration in seconds; 0 takes the duration of the keys, or 4 without keys",
                       Unit::none, 0, 3600),
          o.duration);
    visit(common_field("rate", "Number of frames per second", Unit::none, 1, 240), o.rate);
    visit(Field{"gif_colors", "colours of a GIF; fewer make it smaller", Unit::none, 2, 255}, o.gif_colors);
}

}  // namespace coppice
