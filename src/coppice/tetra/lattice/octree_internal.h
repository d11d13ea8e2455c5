#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "coppice/base/column.h"
#include "coppice/base/context.h"
#include "coppice/base/id.h"

namespace coppice {

/// Returns the code of one of the 27 steps to a cell of the same size around a cell: x, y, z in -1 .. 1. Code
/// 13 is the null step.
constexpr unsigned step_code(int x, int y, int z) {
    return static_cast<unsigned>(x + 1 + 3 * (y + 1) + 9 * (z + 1));
}

/// Position of the neighbour of a child: one step from the parent, and an octant there.
struct ChildStep {
    std::uint8_t step, octant;
};
constexpr std::array<std::array<ChildStep, 27>, 8> make_child_steps() {
    std::array<std::array<ChildStep, 27>, 8> out{};
    for (int o = 0; o < 8; ++o) {
        for (int s = 0; s < 27; ++s) {
            const int place[3] = {(o & 1) + s % 3 - 1, (o >> 1 & 1) + s / 3 % 3 - 1, (o >> 2) + s / 9 - 1};
            const auto floor = [&](int axis) { return place[axis] < 0 ? -1 : place[axis] / 2; };
            const int octant = (place[0] & 1) | (place[1] & 1) << 1 | (place[2] & 1) << 2;
            out[static_cast<std::size_t>(o)][static_cast<std::size_t>(s)] = {
                static_cast<std::uint8_t>(step_code(floor(0), floor(1), floor(2))),
                static_cast<std::uint8_t>(octant)};
        }
    }
    return out;
}
inline constexpr std::array<std::array<ChildStep, 27>, 8> kChildStep = make_child_steps();

/// A cube divided recursively into eight, in which adjacent cells differ by at most one level.
///
/// Cells of one level are identified by Morton keys: bits x, y, z of each level, the highest first.
/// Coordinates are integers from 0 to kSide over the side of the cube, chosen so that centers of the smallest
/// cells are integers. The eight children of split cell number s are the nodes 8 s + 1 .. 8 s + 8; node 0 is
/// the cube. Split cells are numbered level by level, leaves along the Morton curve. 20 bytes per node and 4
/// per leaf.
class Octree {
  public:
    static constexpr unsigned kMaxLevels = 21;
    static constexpr std::uint32_t kSide = 1u << (kMaxLevels + 1);

    struct Cell {
        std::array<std::uint32_t, 3> low{};
        std::uint32_t side = 0;
    };

    /// split[l] contains the keys of the cells of level l to split, ascending; the parents of a split cell
    /// must be split. Splits further cells until neighbours across faces, edges and corners differ by at most
    /// one level.
    Octree(std::vector<Buffer<std::uint64_t>> split, const Context& ctx);

    std::uint32_t leaf_count() const { return static_cast<std::uint32_t>(node_of_leaf_.size()); }
    std::uint32_t node_count() const { return static_cast<std::uint32_t>(link_.size()); }
    std::uint32_t node_of_leaf(std::uint32_t leaf) const { return node_of_leaf_[leaf]; }
    bool is_leaf(std::uint32_t node) const { return link_[node] < kSplit; }
    std::uint32_t leaf(std::uint32_t node) const { return link_[node]; }
    std::uint32_t child(std::uint32_t node, unsigned octant) const {
        return 8 * (link_[node] - kSplit) + 1 + octant;
    }
    Cell cell(std::uint32_t leaf) const {
        const std::uint32_t node = node_of_leaf_[leaf];
        return node == 0 ? Cell{{0, 0, 0}, kSide}
                         : child_cell(cell_of_split_[(node - 1) / 8], (node - 1) % 8);
    }

    /// The neighbour one step from a node: the node of equal size, or the leaf of twice its size that
    /// contains this position as its octant `octant`. kNoIndex outside the cube.
    struct Neighbor {
        std::uint32_t node = kNoIndex;
        bool larger = false;
        unsigned octant = 0;
    };
    Neighbor neighbor(std::uint32_t node, unsigned step) const {
        if (node == 0) return {};
        const ChildStep way = kChildStep[(node - 1) % 8][step];
        const std::uint32_t there = around_split_[(node - 1) / 8][way.step];
        if (there == kNoIndex) return {};
        if (is_leaf(there)) return {there, true, way.octant};
        return {child(there, way.octant), false, way.octant};
    }

    /// Returns the leaf that contains a point with coordinates below kSide; on a border, the upper leaf.
    std::uint32_t leaf_at(std::array<std::uint32_t, 3> point) const;

  private:
    static constexpr std::uint32_t kSplit = 0x80000000u;

    static Cell child_cell(const Cell& parent, unsigned octant) {
        const std::uint32_t half = parent.side / 2;
        return {{parent.low[0] + (octant & 1) * half, parent.low[1] + (octant >> 1 & 1) * half,
                 parent.low[2] + (octant >> 2) * half},
                half};
    }
    void link_nodes(const std::vector<Buffer<std::uint64_t>>& split, const Context& ctx);
    void number_leaves();

    Buffer<Cell> cell_of_split_;
    Buffer<std::uint32_t> link_;                          ///< per node: leaf, or kSplit + split cell
    Buffer<std::array<std::uint32_t, 27>> around_split_;  ///< nodes of the same size
    Buffer<std::uint32_t> node_of_leaf_;
};

}  // namespace coppice
