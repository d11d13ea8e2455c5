#pragma once

#include <array>
#include <cstdint>
#include <unordered_map>
#include <vector>

#include "coppice/base/vec.h"

namespace coppice {

/// Parameters of the shade below leaves.
struct ShadeSettings {
    float cell;     ///< [m] edge of a cell
    float shade;    ///< light that is absorbed in the cell of the leaves
    float falloff;  ///< ratio between each layer of cells and the layer above
    int depth;      ///< number of shaded layers below
};

/// Shade in cells of space: leaves shade their own cell and, in every layer below, one additional cell on
/// each side [Palubicki2009]. In integers, so that leaves can be removed exactly, in any order. Memory is
/// only used for blocks of cells that were ever shaded.
class ShadeGrid {
  public:
    explicit ShadeGrid(const ShadeSettings& settings);

    void add(Vec3 leaves) { cast(leaves, 1); }      ///< O(depth^3)
    void remove(Vec3 leaves) { cast(leaves, -1); }  ///< removes leaves added before
    double shade(Vec3 p) const;                     ///< absorbed light at p; >= 0
    Vec3d brighter(Vec3 p) const;  ///< unit vector towards less shade; 0: the shade is uniform
    std::uint64_t bytes() const { return blocks_.size() * (sizeof(Block) + 64); }  ///< approximate memory

  private:
    static constexpr int kBits = 3, kEdge = 1 << kBits;
    using Block = std::array<std::int32_t, kEdge * kEdge * kEdge>;
    struct Cell {
        std::int32_t x, y, z;
    };

    Cell compute_cell(Vec3 p) const;
    static std::uint64_t key(std::int32_t x, std::int32_t y, std::int32_t z);
    static std::size_t within(std::int32_t x, std::int32_t y, std::int32_t z);
    std::int32_t at(Cell c) const;
    Block& block(std::int32_t x, std::int32_t y, std::int32_t z);
    void cast(Vec3 leaves, std::int32_t sign);
    void cast_layer(Cell middle, std::int32_t reach, std::int32_t amount);

    double per_cell_;
    std::vector<std::int32_t> amount_;  // by layer, starting with the layer of the leaves
    std::unordered_map<std::uint64_t, std::uint32_t> number_;
    std::vector<Block> blocks_;
};

}  // namespace coppice
