#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

#include "coppice/mesh/height_texture.h"
#include "coppice/mesh/texture.h"

namespace coppice::pipeline_internal {

/// Means of a height texture over rectangles, from a table of sums [Crow1984]. Heights are shares of the full
/// scale, in [0, 1].
class HeightFilter {
  public:
    /// Throws InvalidInput unless there is a height for every pixel. O(pixels); 8 bytes per pixel.
    explicit HeightFilter(const HeightTexture& texture);

    /// Returns the mean over a rectangle with this centre and size, at least a pixel. O(1).
    double mean(TexturePoint center, TexturePoint size) const;
    double mean() const { return mean_; }  ///< mean of the texture
    /// Returns the maximum difference from the mean.
    double amplitude() const { return amplitude_; }

  private:
    double integral_in_tile(double x, double y) const;
    double integral(double x, double y) const;

    std::size_t width_, height_;
    std::vector<std::uint64_t> sums_;  // of the pixels to the left and below, by corner of pixels
    double mean_ = 0, amplitude_ = 0;
};

}  // namespace coppice::pipeline_internal
