#pragma once

#include <algorithm>
#include <bit>
#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "coppice/base/box.h"
#include "coppice/base/parallel.h"
#include "coppice/spatial/box_tree.h"

namespace coppice {

/// Looks up the boxes of a tree that overlap each of many boxes. Successive ones should be near each other:
/// the tree is then descended once for some dozens of them. One for each thread, as it keeps memory.
class OverlapQueries {
  public:
    /// `boxes` are those that the tree was made of. Refers to both.
    OverlapQueries(const BoxTree& tree, std::span<const Box3> boxes) : tree_(&tree), boxes_(boxes) {}

    /// Calls visit(i, items) for every i of the range, ascending, with all items whose boxes overlap
    /// box_of(i), in the order of BoxTree::visit_overlapping; touching counts.
    template <class BoxOf, class Visit>
    void visit(IndexRange range, const BoxOf& box_of, const Visit& visit) {
        for (std::size_t begin = range.begin; begin < range.end; begin += kBatch)
            visit_batch({begin, std::min(range.end, begin + kBatch)}, box_of, visit);
    }

  private:
    static constexpr std::uint32_t kWidth = BoxGroup::kWidth;
    static constexpr std::size_t kBatch = 32;      // boxes for which the tree is descended once
    static constexpr std::size_t kMaxGroups = 12;  // of items about them, or else fewer boxes are taken

    template <class BoxOf, class Visit>
    void visit_batch(IndexRange range, const BoxOf& box_of, const Visit& visit) {
        find_items(range, box_of);
        if (groups_.size() > kMaxGroups && range.size() > 1) {
            const std::size_t middle = range.begin + range.size() / 2;
            visit_batch({range.begin, middle}, box_of, visit);
            visit_batch({middle, range.end}, box_of, visit);
            return;
        }
        for (std::size_t i = range.begin; i < range.end; ++i) {
            const Box3 box = box_of(i);
            found_.clear();
            for (std::size_t g = 0; g < groups_.size(); ++g) {
                for (std::uint32_t bits = groups_[g].overlapping(box); bits != 0; bits &= bits - 1)
                    found_.push_back(items_[kWidth * g + static_cast<std::size_t>(std::countr_zero(bits))]);
            }
            visit(i, std::span<const std::uint32_t>(found_));
        }
    }

    /// Finds all items that overlap any of the boxes of a range, and some more.
    template <class BoxOf>
    void find_items(IndexRange range, const BoxOf& box_of) {
        Box3 all;
        for (std::size_t i = range.begin; i < range.end; ++i) all.extend(box_of(i));
        items_.clear();
        tree_->visit_overlapping(all, [&](std::uint32_t item) { items_.push_back(item); });
        groups_.resize((items_.size() + kWidth - 1) / kWidth);
        for (std::size_t k = 0; k < kWidth * groups_.size(); ++k)
            groups_[k / kWidth].set(static_cast<std::uint32_t>(k % kWidth),
                                    k < items_.size() ? boxes_[items_[k]] : Box3{});
    }

    const BoxTree* tree_;
    std::span<const Box3> boxes_;
    std::vector<std::uint32_t> items_, found_;  // about a batch, and one of its boxes
    std::vector<BoxGroup> groups_;              // the boxes of items_
};

}  // namespace coppice
