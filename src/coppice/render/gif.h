#pragma once

#include <array>
#include <cstdint>
#include <string>
#include <vector>

#include "coppice/render/image.h"

namespace coppice {

/// Pictures that follow each other, as the bytes of a GIF file that repeats for ever. All have the colours
/// that are most in the first one, whose pixels count as opaque; of each only what differs from
/// the one before is held. The same pictures give the same bytes. The caller writes them; nothing is written
/// here.
class GifEncoder {
  public:
    /// `colors` in [2, 255], fewer for smaller files; `delay` [s] from one picture to the next, in
    /// hundredths; at least two of them, as viewers take less for more.
    GifEncoder(const Image& first, double delay, int colors = 255);

    /// What the file begins with.
    std::string head() const;
    /// What the next picture adds; the first one is to be added too. Throws InvalidInput when its size
    /// differs.
    std::string add(const Image& picture);
    /// What the file ends with.
    static std::string tail() { return ";"; }

  private:
    std::uint8_t index_of(const Image::Pixel& pixel);

    int width_, height_;
    unsigned delay_;                                   ///< [1/100 s]
    std::vector<std::array<std::uint8_t, 3>> colors_;  ///< the palette
    std::vector<std::int16_t> nearest_;  ///< by the upper five bits of each channel; -1: not asked yet
    std::vector<std::uint8_t> last_;     ///< the picture before, by palette; empty at first
};

}  // namespace coppice
