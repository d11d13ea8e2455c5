#pragma once

#include "coppice/render/image.h"
#include "coppice/sketch/trace/mask.h"

namespace coppice {

/// Returns the mask of the foreground: the pixels with more than half opacity if the image has alpha, else
/// those that differ in colour from the median of the image border by more than the threshold of [Otsu1979].
/// For images of a tree before a plain sky or wall, and for silhouettes. Throws InvalidInput for an image
/// without pixels. O(pixels).
Mask compute_silhouette(const Image& image);

}  // namespace coppice
