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

/// Finds the boxes of a tree that overlap each of many boxes. Successive boxes should be close to each other:
/// the tree is then traversed once for some dozens of them. Keeps buffers: use one object per thread.
class OverlapQueries {
  public:
    /// `boxes` are the input of the tree. Refers to both.
    OverlapQueries(const BoxTree& tree, std::span<const Box3> boxes) : tree_(&tree), boxes_(boxes) {}

    /// Calls visit(i, items) for every i of the range, ascending, with all items that have boxes overlapping
    /// compute_box(i), in the order of BoxTree::visit_overlapping; touching boxes overlap.
    template <class BoxOf, class Visit>
    void visit(IndexRange range, const BoxOf& compute_box, const Visit& visit) {
        for (std::size_t begin = range.begin; begin < range.end; begin += kBatch)
            visit_batch({begin, std::min(range.end, begin + kBatch)}, compute_box, visit);
    }

  private:
    static constexpr std::uint32_t kWidth = BoxGroup::kWidth;
    static constexpr std::size_t kBatch = 32;  // number of boxes per traversal of the tree
    static constexpr std::size_t kPart = 4;    // number of boxes per part of a batch with many items
    // maximum number of groups of items that each box is tested against
    static constexpr std::size_t kMaxGroups = 6;
    // maximum number of items of a batch; otherwise it is divided
    static constexpr std::size_t kMaxItems = 1024;

    /// Items with their boxes.
    struct Items {
        std::vector<std::uint32_t> index;
        std::vector<BoxGroup> groups;

        void clear() {
            index.clear();
            groups.clear();
        }
        void add(std::uint32_t item, const Box3& box) {
            const std::uint32_t place = static_cast<std::uint32_t>(index.size()) % kWidth;
            if (place == 0) {
                groups.emplace_back();
                for (std::uint32_t i = 1; i < kWidth; ++i) groups.back().set(i, Box3{});
            }
            groups.back().set(place, box);
            index.push_back(item);
        }
        /// Calls visit(item) for the items with boxes that overlap the given one.
        template <class Visit>
        void visit_overlapping(const Box3& box, const Visit& visit) const {
            for (std::size_t g = 0; g < groups.size(); ++g) {
                for (std::uint32_t bits = groups[g].overlapping(box); bits != 0; bits &= bits - 1)
                    visit(index[kWidth * g + static_cast<std::size_t>(std::countr_zero(bits))]);
            }
        }
    };

    template <class BoxOf>
    static Box3 bounds(IndexRange range, const BoxOf& compute_box) {
        Box3 all;
        for (std::size_t i = range.begin; i < range.end; ++i) all.extend(compute_box(i));
        return all;
    }

    template <class BoxOf, class Visit>
    void visit_batch(IndexRange range, const BoxOf& compute_box, const Visit& visit) {
        about_batch_.clear();
        tree_->visit_overlapping(bounds(range, compute_box),
                                 [&](std::uint32_t item) { about_batch_.add(item, boxes_[item]); });
        if (about_batch_.index.size() > kMaxItems && range.size() > 1) {
            const std::size_t middle = range.begin + range.size() / 2;
            visit_batch({range.begin, middle}, compute_box, visit);
            visit_batch({middle, range.end}, compute_box, visit);
            return;
        }
        if (about_batch_.groups.size() <= kMaxGroups)
            return visit_part(range, about_batch_, compute_box, visit);
        for (std::size_t begin = range.begin; begin < range.end; begin += kPart) {
            const IndexRange part{begin, std::min(range.end, begin + kPart)};
            about_part_.clear();
            about_batch_.visit_overlapping(bounds(part, compute_box),
                                           [&](std::uint32_t item) { about_part_.add(item, boxes_[item]); });
            visit_part(part, about_part_, compute_box, visit);
        }
    }

    template <class BoxOf, class Visit>
    void visit_part(IndexRange range, const Items& items, const BoxOf& compute_box, const Visit& visit) {
        for (std::size_t i = range.begin; i < range.end; ++i) {
            found_.clear();
            items.visit_overlapping(compute_box(i), [&](std::uint32_t item) { found_.push_back(item); });
            visit(i, std::span<const std::uint32_t>(found_));
        }
    }

    const BoxTree* tree_;
    std::span<const Box3> boxes_;
    Items about_batch_, about_part_;
    std::vector<std::uint32_t> found_;
};

}  // namespace coppice
