#pragma once

#include <algorithm>
#include <cstdint>
#include <span>

#include "coppice/base/column.h"
#include "coppice/base/random.h"
#include "coppice/base/vec.h"

namespace coppice::points_internal {

/// Points in a hash grid, found by distance. Distances are exact: those of the float positions in double
/// precision.
class PointHash {
  public:
    /// `edge` of the grid's cells [m], above 0; queries that reach no farther look at 27 cells.
    PointHash(double edge, std::size_t expected) : inverse_(1 / edge) {
        std::size_t buckets = 64;
        while (buckets < 2 * expected) buckets *= 2;
        head_.assign(buckets, kNone);
    }
    static double bytes(double count) { return 4 * 4 * count + (sizeof(Node) + 4) * count; }

    std::size_t size() const { return nodes_.size(); }
    Vec3 operator[](std::size_t i) const { return nodes_[i].position; }

    void insert(Vec3 p) {
        if (2 * nodes_.size() >= head_.size()) grow();
        nodes_.push_back({p, kNone, key(cell(p.x), cell(p.y), cell(p.z))});
        link(static_cast<std::uint32_t>(nodes_.size()) - 1);
    }

    /// Calls visit(index, squared distance) for the points within `radius`, the latest of a cell first; a
    /// visit that returns false ends the search. False when one did.
    template <class Visit>
    bool visit(Vec3 p, double radius, const Visit& visit) const {
        const double radius2 = radius * radius;
        const std::int64_t x0 = floor((p.x - radius) * inverse_), x1 = floor((p.x + radius) * inverse_);
        const std::int64_t y0 = floor((p.y - radius) * inverse_), y1 = floor((p.y + radius) * inverse_);
        const std::int64_t z0 = floor((p.z - radius) * inverse_), z1 = floor((p.z + radius) * inverse_);
        for (std::int64_t z = z0; z <= z1; ++z) {
            for (std::int64_t y = y0; y <= y1; ++y) {
                const std::uint64_t row = key(0, y, z);
                for (std::int64_t x = x0; x <= x1; ++x) {
                    const std::uint64_t wanted = row + static_cast<std::uint64_t>(x);
                    for (std::uint32_t n = head_[wanted & (head_.size() - 1)]; n != kNone;) {
                        const Node& node = nodes_[n];
                        const double d2 = length_squared(Vec3d(node.position) - Vec3d(p));
                        if (d2 <= radius2 && node.key == wanted && !visit(n, d2)) return false;
                        n = node.next;
                    }
                }
            }
        }
        return true;
    }

    /// Whether a point is nearer to p than `distance`.
    bool any_nearer(Vec3 p, double distance) const {
        const double limit = distance * distance;
        return !visit(p, distance, [&](std::uint32_t, double d2) { return d2 >= limit; });
    }

  private:
    static constexpr std::uint32_t kNone = 0xffffffffu;
    struct Node {
        Vec3 position;
        std::uint32_t next;
        std::uint64_t key;
    };

    /// Faster than std::floor, which is a call on processors without a word for it.
    static std::int64_t floor(double x) {
        const auto whole = static_cast<std::int64_t>(x);
        return whole - (static_cast<double>(whole) > x ? 1 : 0);
    }
    std::int64_t cell(float x) const { return floor(x * inverse_); }
    /// Cells in a row along x have keys in a row, so that their buckets lie together.
    static std::uint64_t key(std::int64_t x, std::int64_t y, std::int64_t z) {
        const std::uint64_t yz =
            static_cast<std::uint64_t>(y) * 0x9e3779b97f4a7c15ull + static_cast<std::uint64_t>(z);
        return static_cast<std::uint64_t>(x) + mix_bits(yz);
    }
    void link(std::uint32_t n) {
        std::uint32_t& head = head_[nodes_[n].key & (head_.size() - 1)];
        nodes_[n].next = head;
        head = n;
    }
    void grow() {
        head_.assign(2 * head_.size(), kNone);
        for (std::uint32_t n = 0; n < nodes_.size(); ++n) link(n);
    }

    double inverse_;
    Buffer<std::uint32_t> head_;
    Buffer<Node> nodes_;
};

}  // namespace coppice::points_internal
