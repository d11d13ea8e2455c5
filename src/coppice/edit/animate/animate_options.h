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

/// Lists the members for front ends.
void list_fields(AnimateOptions& o, FieldList& list);

}  // namespace coppice
