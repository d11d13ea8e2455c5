#pragma once

#include <span>

#include "coppice/render/image.h"

namespace coppice {

/// Pictures of one size side by side, row by row, `columns` > 0 of them in each; 0 makes the sheet about
/// square. What is left over is white. Throws InvalidInput without pictures, when their sizes differ, and for
/// sheets of more than 128 million pixels. O(pixels).
Image contact_sheet(std::span<const Image> pictures, int columns = 0);

}  // namespace coppice
