#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <vector>

namespace coppice {

/// An image of 8 bits per channel: sRGB colour, not premultiplied, and linear alpha. Row 0 is at the top.
struct Image {
    using Pixel = std::array<std::uint8_t, 4>;  ///< red, green, blue, alpha

    int width = 0;              ///< [pixels]
    int height = 0;             ///< [pixels]
    std::vector<Pixel> pixels;  ///< width * height, row by row

    Image() = default;
    /// Transparent black.
    Image(int width_, int height_)
        : width(width_),
          height(height_),
          pixels(static_cast<std::size_t>(width_) * static_cast<std::size_t>(height_)) {}

    /// x < width from the left, y < height from the top
    Pixel& at(int x, int y) { return pixels[index(x, y)]; }
    /// x < width from the left, y < height from the top
    const Pixel& at(int x, int y) const { return pixels[index(x, y)]; }
    friend bool operator==(const Image&, const Image&) = default;  ///< compares all pixels

  private:
    std::size_t index(int x, int y) const {
        return static_cast<std::size_t>(y) * static_cast<std::size_t>(width) + static_cast<std::size_t>(x);
    }
};

}  // namespace coppice
