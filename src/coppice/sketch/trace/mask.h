#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

namespace coppice {

/// Silhouette: the pixels of an image that show the tree.
struct Mask {
    int width = 0;                     ///< [pixels]
    int height = 0;                    ///< [pixels]
    std::vector<std::uint8_t> inside;  ///< width * height, by rows from the top: 1 or 0

    Mask() = default;
    /// Creates an empty silhouette.
    Mask(int width_, int height_)
        : width(width_),
          height(height_),
          inside(static_cast<std::size_t>(width_) * static_cast<std::size_t>(height_)) {}

    /// Returns the index of a pixel in `inside`.
    std::size_t index(int x, int y) const {
        return static_cast<std::size_t>(y) * static_cast<std::size_t>(width) + static_cast<std::size_t>(x);
    }
    /// Returns whether a pixel shows the tree; false outside the image.
    bool at(int x, int y) const {
        return x >= 0 && y >= 0 && x < width && y < height && inside[index(x, y)] != 0;
    }
};

}  // namespace coppice
