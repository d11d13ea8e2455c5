#pragma once

#include "coppice/render/image.h"
#include "coppice/sketch/trace/mask.h"

namespace coppice {

/// What of a picture is not background: where alpha tells, what is more than half opaque; else what differs
/// in colour from the median of the picture's edge by more than [Otsu1979] takes for noise. Pictures of a
/// tree before a sky or a wall that is plain, and silhouettes. Throws InvalidInput for a picture without
/// pixels. O(pixels).
Mask silhouette_of(const Image& image);

}  // namespace coppice
