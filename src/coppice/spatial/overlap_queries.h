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
    static constexpr std::size_t kBatch = 32;       // boxes for which the tree is descended once
    static constexpr std::size_t kPart = 4;         // of them, where there are many items about a batch
    static constexpr std::size_t kMaxGroups = 6;    // of items, each of which a box is tested against
    static constexpr std::size_t kMaxItems = 1024;  // about a batch, or else it is divided

    /// Some items with their boxes.
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
        /// Calls visit(item) for those whose boxes overlap the given one.
        template <class Visit>
        void visit_overlapping(const Box3& box, const Visit& visit) const {
            for (std::size_t g = 0; g < groups.size(); ++g) {
                for (std::uint32_t bits = groups[g].overlapping(box); bits != 0; bits &= bits - 1)
                    visit(index[kWidth * g + static_cast<std::size_t>(std::countr_zero(bits))]);
            }
        }
    };

    template <class BoxOf>
    static Box3 bounds(IndexRange range, const BoxOf& box_of) {
        Box3 all;
        for (std::size_t i = range.begin; i < range.end; ++i) all.extend(box_of(i));
        return all;
    }

    template <class BoxOf, class Visit>
    void visit_batch(IndexRange range, const BoxOf& box_of, const Visit& visit) {
        about_batch_.clear();
        tree_->visit_overlapping(bounds(range, box_of),
                                 [&](std::uint32_t item) { about_batch_.add(item, boxes_[item]); });
        if (about_batch_.index.size() > kMaxItems && range.size() > 1) {
            const std::size_t middle = range.begin + range.size() / 2;
            visit_batch({range.begin, middle}, box_of, visit);
            visit_batch({middle, range.end}, box_of, visit);
            return;
        }
        if (about_batch_.groups.size() <= kMaxGroups) return visit_part(range, about_batch_, box_of, visit);
        for (std::size_t begin = range.begin; begin < range.end; begin += kPart) {
            const IndexRange part{begin, std::min(range.end, begin + kPart)};
            about_part_.clear();
            about_batch_.visit_overlapping(bounds(part, box_of),
                                           [&](std::uint32_t item) { about_part_.add(item, boxes_[item]); });
            visit_part(part, about_part_, box_of, visit);
        }
    }

    template <class BoxOf, class Visit>
    void visit_part(IndexRange range, const Items& items, const BoxOf& box_of, const Visit& visit) {
        for (std::size_t i = range.begin; i < range.end; ++i) {
            found_.clear();
            items.visit_overlapping(box_of(i), [&](std::uint32_t item) { found_.push_back(item); });
            visit(i, std::span<const std::uint32_t>(found_));
        }
    }

    const BoxTree* tree_;
    std::span<const Box3> boxes_;
    Items about_batch_, about_part_;
    std::vector<std::uint32_t> found_;
};

}  // namespace coppice
