#pragma once

#include <array>
#include <cstdint>
#include <unordered_map>
#include <vector>

#include "coppice/base/vec.h"

namespace coppice {

/// How leaves shade what is below them.
struct ShadeSettings {
    float cell;     ///< [m] edge of a cell
    float shade;    ///< light that is taken in the cell of the leaves
    float falloff;  ///< of that from each layer of cells to the next one below
    int depth;      ///< layers below that are shaded
};

/// Shade in cells of space: leaves shade their own cell and, in every layer below, one cell more to each side
/// [Palubicki2009]. In whole numbers, so that leaves which go leave nothing behind, in any order. Only blocks
/// of cells that were ever shaded take memory.
class ShadeGrid {
  public:
    explicit ShadeGrid(const ShadeSettings& settings);

    void add(Vec3 leaves) { cast(leaves, 1); }      ///< O(depth^3)
    void remove(Vec3 leaves) { cast(leaves, -1); }  ///< what was added before
    double shade(Vec3 p) const;                     ///< light that is taken there; >= 0
    Vec3d brighter(Vec3 p) const;  ///< unit vector to where there is less shade; 0: it is even
    std::uint64_t bytes() const { return blocks_.size() * (sizeof(Block) + 64); }  ///< of memory, about

  private:
    static constexpr int kBits = 3, kEdge = 1 << kBits;
    using Block = std::array<std::int32_t, kEdge * kEdge * kEdge>;
    struct Cell {
        std::int32_t x, y, z;
    };

    Cell cell_of(Vec3 p) const;
    static std::uint64_t key(std::int32_t x, std::int32_t y, std::int32_t z);
    static std::size_t within(std::int32_t x, std::int32_t y, std::int32_t z);
    std::int32_t at(Cell c) const;
    Block& block(std::int32_t x, std::int32_t y, std::int32_t z);
    void cast(Vec3 leaves, std::int32_t sign);
    void cast_layer(Cell middle, std::int32_t reach, std::int32_t amount);

    double per_cell_;
    std::vector<std::int32_t> amount_;  // by layer from the leaves' own on
    std::unordered_map<std::uint64_t, std::uint32_t> number_;
    std::vector<Block> blocks_;
};

}  // namespace coppice
