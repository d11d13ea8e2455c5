#pragma once

#include <algorithm>
#include <bit>
#include <cstdint>
#include <span>
#include <vector>

#include "coppice/skeleton/skeleton.h"

namespace coppice::cage_internal {

/// The axes of a skeleton: chains that follow the leader, each from a root or branch node to a tip. Segments
/// are ranked so that the thickest segment that begins at an already ranked one comes next, where an axis
/// keeps its thickness until it has lost a third of it: so of two similar axes that cross, one comes first
/// along the whole crossing. Axes are numbered by the rank of their first segments.
class Axes {
  public:
    /// O(n log n).
    explicit Axes(const Skeleton& s)
        : arc_(s.size()), axis_(s.size(), 0), place_(s.size(), 0), rank_(s.size(), 0) {
        std::vector<std::uint64_t> heap;
        std::vector<float> thickness(s.size(), 0);
        const auto wait_for_children = [&](NodeId n) {
            for (const NodeId c : s.children(n)) {
                const float before = s.is_root(n) || s.leader(n) != c ? 0 : thickness[n.index()];
                const float r = s.radius(c);
                thickness[c.index()] = r > kSameThickness * before ? std::max(r, before) : r;
                heap.push_back(key(thickness[c.index()], c));
                std::push_heap(heap.begin(), heap.end());
            }
        };
        for (const NodeId n : nodes(s)) {
            if (s.is_root(n)) wait_for_children(n);
        }
        nodes_.reserve(s.size());
        for (std::uint32_t rank = 0; !heap.empty(); ++rank) {
            std::pop_heap(heap.begin(), heap.end());
            const NodeId n(~static_cast<std::uint32_t>(heap.back()));
            heap.pop_back();
            rank_[n.index()] = rank;
            wait_for_children(n);
            const NodeId p = s.parent(n);
            if (s.is_root(p) || s.leader(p) != n) add_axis(s, n);
        }
    }

    std::uint32_t count() const { return static_cast<std::uint32_t>(first_.size() - 1); }
    std::span<const NodeId> find_nodes(std::uint32_t axis) const {
        return std::span(nodes_).subspan(first_[axis], first_[axis + 1] - first_[axis]);
    }
    /// Returns the axis of the segment that ends at a node that is not a root.
    std::uint32_t find_axis(NodeId n) const { return axis_[n.index()]; }
    /// [m] Returns the length along the axis from its beginning to the node.
    float arc(NodeId n) const { return arc_[n.index()]; }
    bool is_first(NodeId n) const { return place_[n.index()] == first_[find_axis(n)]; }
    std::uint32_t rank(NodeId n) const { return rank_[n.index()]; }
    NodeId next(NodeId n) const {
        const std::uint32_t i = place_[n.index()] + 1;
        return i < first_[find_axis(n) + 1] ? nodes_[i] : NodeId::none();
    }

  private:
    static constexpr float kSameThickness = 2.0f / 3;

    // Thicker segments, and of equals the one with the lower index, have the greater key: the bits of
    // positive numbers have the same order as the numbers.
    static std::uint64_t key(float radius, NodeId n) {
        return std::uint64_t{std::bit_cast<std::uint32_t>(radius)} << 32 | ~n.index();
    }

    void add_axis(const Skeleton& s, NodeId head) {
        float way = 0;
        for (NodeId n = head; n; n = s.leader(n)) {
            way += distance(s.position(n), s.position(s.parent(n)));
            arc_[n.index()] = way;
            axis_[n.index()] = count();
            place_[n.index()] = static_cast<std::uint32_t>(nodes_.size());
            nodes_.push_back(n);
        }
        first_.push_back(static_cast<std::uint32_t>(nodes_.size()));
    }

    std::vector<NodeId> nodes_;
    std::vector<std::uint32_t> first_{0};
    std::vector<float> arc_;
    std::vector<std::uint32_t> axis_, place_, rank_;
};

}  // namespace coppice::cage_internal
