#pragma once

#include <algorithm>
#include <cstdint>

#include "coppice/io_points/las_internal.h"
#include "coppice/io_points/laz/integers_internal.h"
#include "coppice/io_points/laz/prediction_internal.h"

namespace coppice::io_internal {

/// Decoder of colours in version 1 of [Isenburg2013]: the differences of the bytes that changed.
class OldColorDecoder {
  public:
    Rgb16 read(ArithmeticDecoder& in, Rgb16 color) {
        const unsigned changes = in.symbol(changes_);
        for (unsigned i = 0; i < 6; ++i) {
            if ((changes >> i & 1u) == 0) continue;
            const unsigned shift = i % 2 * 8;
            const std::uint32_t byte = bytes_.read(in, color[i / 2] >> shift & 255u, i);
            color[i / 2] = static_cast<std::uint16_t>((color[i / 2] & 0xff00u >> shift) | byte << shift);
        }
        return color;
    }

  private:
    SymbolModel changes_{64};
    IntegerDecoder bytes_{8, 6};
};

/// Decoder of colours in later versions: green and blue are predicted from the change of red, or equal red.
class ColorDecoder {
  public:
    Rgb16 read(ArithmeticDecoder& in, const Rgb16& last) {
        const unsigned changes = in.symbol(changes_);
        const auto byte = [&](unsigned place, int predicted, int before) {
            if ((changes >> place & 1u) == 0) return before;
            return (static_cast<int>(in.symbol(differences_[place])) + std::clamp(predicted, 0, 255)) & 255;
        };
        const int low = byte(0, last[0] & 255, last[0] & 255), high = byte(1, last[0] >> 8, last[0] >> 8);
        const Rgb16 grey = rgb({low, low, low}, {high, high, high});
        if ((changes & 64u) == 0) return grey;
        int lows[3] = {low, 0, 0}, highs[3] = {high, 0, 0};
        const auto read_others = [&](int* bytes, unsigned place, unsigned shift) {
            const auto before = [&](std::size_t i) { return last[i] >> shift & 255; };
            int change = bytes[0] - before(0);
            bytes[1] = byte(place, change + before(1), before(1));
            change = (change + bytes[1] - before(1)) / 2;
            bytes[2] = byte(place + 2, change + before(2), before(2));
        };
        read_others(lows, 2, 0);
        read_others(highs, 3, 8);
        return rgb({lows[0], lows[1], lows[2]}, {highs[0], highs[1], highs[2]});
    }

  private:
    static Rgb16 rgb(const std::array<int, 3>& lows, const std::array<int, 3>& highs) {
        const auto number = [&](std::size_t i) {
            return static_cast<std::uint16_t>(highs[i] << 8 | lows[i]);
        };
        return {number(0), number(1), number(2)};
    }

    SymbolModel changes_{128};
    SymbolModels differences_{6, 256};
};

}  // namespace coppice::io_internal
