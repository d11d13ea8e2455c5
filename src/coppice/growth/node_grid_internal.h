#pragma once

#include <cmath>
#include <cstdint>
#include <span>

#include "coppice/base/column.h"
#include "coppice/base/random.h"
#include "coppice/base/vec.h"

namespace coppice {

/// Finds nodes within a fixed distance of a point. A hash table of cells that doubles with the number of
/// nodes; every query visits eight cells.
class NodeGrid {
  public:
    explicit NodeGrid(float distance)
        : distance_squared_(distance * distance), per_cell_(1 / (2.0 * distance)), head_(1024, kEnd) {}

    /// Inserts nodes.back(); nodes must be inserted in order. A passed node is counted but never found, so
    /// that cells do not fill up with dense existing nodes.
    void insert(std::span<const Vec3> nodes, bool passed = false) {
        const auto last = static_cast<std::uint32_t>(nodes.size() - 1);
        next_.push_back(passed ? last : kEnd);
        if (nodes.size() * 2 > head_.size()) {
            head_.assign(2 * head_.size(), kEnd);
            for (std::uint32_t i = 0; i < nodes.size(); ++i) {
                if (next_[i] != i) link(i, nodes[i]);
            }
        } else if (!passed) {
            link(last, nodes.back());
        }
    }

    /// Returns whether a node with index >= `first` is nearer to p than the distance.
    bool any_near(Vec3 p, std::span<const Vec3> nodes, std::uint32_t first) const {
        const Cell corner = compute_cell(Vec3d(p) * per_cell_ - Vec3d{0.5, 0.5, 0.5});
        for (int i = 0; i < 8; ++i) {
            const Cell c{corner.x + (i & 1), corner.y + (i >> 1 & 1), corner.z + (i >> 2)};
            // Chains start with the latest node.
            for (std::uint32_t n = head_[slot(c)]; n != kEnd && n >= first; n = next_[n]) {
                if (length_squared(nodes[n] - p) < distance_squared_) return true;
            }
        }
        return false;
    }

  private:
    static constexpr std::uint32_t kEnd = 0xffffffffu;
    struct Cell {
        std::int64_t x, y, z;
    };

    static Cell compute_cell(Vec3d scaled) {
        return {static_cast<std::int64_t>(std::floor(scaled.x)),
                static_cast<std::int64_t>(std::floor(scaled.y)),
                static_cast<std::int64_t>(std::floor(scaled.z))};
    }
    /// Adjacent cells are stored together in blocks of 64. Different cells may share a slot, because the
    /// distance decides.
    std::size_t slot(Cell c) const {
        const auto bits = [](std::int64_t i) { return static_cast<std::uint64_t>(i >> 2) & 0x1fffffu; };
        const std::uint64_t block = mix_bits(bits(c.x) | bits(c.y) << 21 | bits(c.z) << 42);
        const auto within = static_cast<std::uint64_t>((c.x & 3) | (c.y & 3) << 2 | (c.z & 3) << 4);
        return (block << 6 | within) & (head_.size() - 1);
    }
    void link(std::uint32_t node, Vec3 p) {
        std::uint32_t& head = head_[slot(compute_cell(Vec3d(p) * per_cell_))];
        next_[node] = head;
        head = node;
    }

    float distance_squared_;
    double per_cell_;
    Buffer<std::uint32_t> head_;
    Buffer<std::uint32_t> next_;
};

}  // namespace coppice
