#pragma once

#include <algorithm>
#include <cstdint>
#include <span>

#include "coppice/base/column.h"
#include "coppice/base/id.h"
#include "coppice/base/random.h"
#include "coppice/base/vec.h"

namespace coppice::points_internal {

/// Points in a hash grid with queries by distance. Distances are exact: those of the float positions in
/// double precision.
class PointHash {
  public:
    /// `edge` [m] is the edge of the cells, above 0; queries with a smaller radius visit 27 cells.
    PointHash(double edge, std::size_t expected) : inverse_(1 / edge) {
        std::size_t buckets = 64;
        while (buckets < 2 * expected) buckets *= 2;
        head_.assign(buckets, kNoIndex);
    }
    static double bytes(double count) { return 4 * 4 * count + (sizeof(Node) + 4) * count; }

    std::size_t size() const { return nodes_.size(); }
    Vec3 operator[](std::size_t i) const { return nodes_[i].position; }

    void insert(Vec3 p) {
        if (2 * nodes_.size() >= head_.size()) grow();
        nodes_.push_back({p, kNoIndex, key(cell(p.x), cell(p.y), cell(p.z))});
        link(static_cast<std::uint32_t>(nodes_.size()) - 1);
    }

    /// Calls visit(index, squared distance) for the points within `radius`, the last point of a cell first. A
    /// visit that returns false ends the search; the function then returns false.
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
                    for (std::uint32_t n = head_[wanted & (head_.size() - 1)]; n != kNoIndex;) {
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

    /// Returns whether a point is closer to p than `distance`.
    bool any_nearer(Vec3 p, double distance) const {
        const double limit = distance * distance;
        return !visit(p, distance, [&](std::uint32_t, double d2) { return d2 >= limit; });
    }

  private:
    struct Node {
        Vec3 position;
        std::uint32_t next;
        std::uint64_t key;
    };

    /// Faster than std::floor, which is a function call on processors without an instruction for it.
    static std::int64_t floor(double x) {
        const auto whole = static_cast<std::int64_t>(x);
        return whole - (static_cast<double>(whole) > x ? 1 : 0);
    }
    std::int64_t cell(float x) const { return floor(x * inverse_); }
    /// Consecutive cells along x have consecutive keys, so that their buckets are adjacent.
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
        head_.assign(2 * head_.size(), kNoIndex);
        for (std::uint32_t n = 0; n < nodes_.size(); ++n) link(n);
    }

    double inverse_;
    Buffer<std::uint32_t> head_;
    Buffer<Node> nodes_;
};

}  // namespace coppice::points_internal
