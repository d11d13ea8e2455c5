#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <functional>
#include <span>
#include <string_view>
#include <vector>

#include "coppice/base/box.h"
#include "coppice/base/context.h"
#include "coppice/implicit/solid/solid_field.h"

namespace coppice {

/// Evaluates the values of a field, without gradients.
using ValueFunction = std::function<void(std::span<const Vec3>, std::span<float>)>;
ValueFunction to_value_function(FieldRef field, std::uint32_t region = 0);

/// Cubic cells in blocks of 8 x 8 x 8; blocks are numbered with x fastest.
struct BlockLattice {
    static constexpr std::uint32_t kCells = 8;           ///< number of cells along a side of a block
    static constexpr std::uint32_t kNodes = kCells + 1;  ///< number of corners of cells along a side
    static constexpr std::size_t kBlockNodes = kNodes * kNodes * kNodes;

    Vec3d origin;
    double cell = 1;  ///< [m]
    std::array<std::uint32_t, 3> blocks{1, 1, 1};

    std::size_t block_count() const { return std::size_t{blocks[0]} * blocks[1] * blocks[2]; }
    std::array<std::uint32_t, 3> place(std::size_t block) const {
        return {static_cast<std::uint32_t>(block % blocks[0]),
                static_cast<std::uint32_t>(block / blocks[0] % blocks[1]),
                static_cast<std::uint32_t>(block / blocks[0] / blocks[1])};
    }
    std::size_t block_at(std::uint32_t x, std::uint32_t y, std::uint32_t z) const {
        return (std::size_t{z} * blocks[1] + y) * blocks[0] + x;
    }
    /// The result does not depend on the block (bit-identical).
    Vec3 node(std::uint32_t x, std::uint32_t y, std::uint32_t z) const {
        return Vec3(origin + Vec3d{double(x), double(y), double(z)} * cell);
    }
    Box3 box(std::size_t block) const;
    /// Returns, along each axis, the first block that touches the box and the one after the last; touching
    /// counts, with a small tolerance.
    std::array<std::array<std::uint32_t, 3>, 2> blocks_touching(const Box3& box) const;
    /// Writes the corners of its cells, x fastest.
    void find_nodes(std::size_t block, std::span<Vec3> out) const;
};

/// Returns the lattice that covers the box; a `cell` of 0 is 1/64 of its longest side. Throws InvalidInput,
/// with the prefix `subject`, for a box that is not finite, an invalid cell, and more than `max_blocks`
/// blocks.
BlockLattice cover(const Box3& box, float cell, std::string_view subject, std::size_t max_blocks);

/// Returns bounds of the values in every block.
std::vector<ValueRange> block_ranges(const BlockLattice& lattice, const SolidField& field,
                                     const Context& ctx);

}  // namespace coppice
