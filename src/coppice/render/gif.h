#pragma once

#include <array>
#include <cstdint>
#include <string>
#include <vector>

#include "coppice/render/image.h"

namespace coppice {

/// Encodes consecutive images as the bytes of an endlessly repeating GIF file. The palette contains the most
/// frequent colours of the first image, all pixels of which count as opaque; each image stores only the
/// differences from the previous one. Equal images give equal bytes. The caller writes the bytes; the encoder
/// writes no files.
class GifEncoder {
  public:
    /// `colors` in [2, 255], fewer for smaller files; `delay` [s] between images, in hundredths, at least
    /// two, because viewers replace shorter delays by longer ones.
    GifEncoder(const Image& first, double delay, int colors = 255);

    /// Returns the header of the file.
    std::string head() const;
    /// Returns the bytes of the next image; the first one must be added too. Throws InvalidInput if its size
    /// differs.
    std::string add(const Image& picture);
    /// Returns the end of the file.
    static std::string tail() { return ";"; }

  private:
    std::uint8_t index_of(const Image::Pixel& pixel);

    int width_, height_;
    unsigned delay_;                                   ///< [1/100 s]
    std::vector<std::array<std::uint8_t, 3>> colors_;  ///< the palette
    std::vector<std::int16_t> nearest_;  ///< by the upper five bits of each channel; -1: not computed yet
    std::vector<std::uint8_t> last_;     ///< the previous image as palette indices; empty at first
};

}  // namespace coppice
