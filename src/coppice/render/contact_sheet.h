#pragma once

#include <span>

#include "coppice/render/image.h"

namespace coppice {

/// Arranges images of the same size in rows of `columns` > 0 images; 0 makes the sheet approximately square.
/// Unused area is white. Throws InvalidInput if there are no images, their sizes differ, or the sheet has
/// more than 128 million pixels. O(pixels).
Image contact_sheet(std::span<const Image> pictures, int columns = 0);

}  // namespace coppice
