#pragma once

#include <cstdint>

namespace coppice {

/// Number of cells along an axis in a Morton code of 63 bits.
inline constexpr std::uint32_t kMortonCells = std::uint32_t{1} << 21;

/// Bits of a Morton code that belong to the first axis; those of axis a are shifted left by a.
inline constexpr std::uint64_t kMortonAxis = 0x1249249249249249ull;

/// Returns the position of cell (x, y, z) along the Morton curve (Z-order): the interleaved bits of the three
/// numbers, x the lowest. Each number must be below kMortonCells.
constexpr std::uint64_t morton_code(std::uint64_t x, std::uint64_t y, std::uint64_t z) {
    const auto spread = [](std::uint64_t v) {  // inserts two zeros after every bit
        v = (v | v << 32) & 0x001f00000000ffffull;
        v = (v | v << 16) & 0x001f0000ff0000ffull;
        v = (v | v << 8) & 0x100f00f00f00f00full;
        v = (v | v << 4) & 0x10c30c30c30c30c3ull;
        return (v | v << 2) & kMortonAxis;
    };
    return spread(x) | spread(y) << 1 | spread(z) << 2;
}

}  // namespace coppice
