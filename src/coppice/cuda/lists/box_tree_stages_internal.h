#pragma once

#include <algorithm>
#include <array>
#include <bit>
#include <cstdint>
#include <span>

#include "coppice/base/box.h"
#include "coppice/base/kernel/partition_point.h"
#include "coppice/cuda/device.h"
#include "coppice/spatial/box_tree_kernel.h"

namespace coppice::cuda {

/// Returns the row of an item of compressed rows: see CompressedRows.
COPPICE_HOST_DEVICE inline std::uint32_t find_row(std::span<const std::uint32_t> first, std::uint32_t item) {
    return kernel::partition_point(first, [&](std::uint32_t f) { return f <= item; }) - 1;
}

/// A range of indices in the order of a tree.
struct PlaceRange {
    std::uint32_t begin, end;  ///< the first, and one past the last
};

/// A BoxTree in the memory of an executor, with the same order and the same boxes. A group is eight boxes
/// that are bounded by one box of the level above.
class DeviceBoxTree {
  public:
    static constexpr std::uint32_t kWidth = BoxGroup::kWidth;  ///< number of boxes in a group
    static constexpr std::uint32_t kMaxLevels = 8;  ///< maximum number of levels that a query supports
    static constexpr std::uint32_t kMaxItems = 1u
                                               << 24;  ///< maximum number of items for that number of levels

    /// Creates a tree of the items in this order with uninitialised groups. Requires at least one item.
    template <class Exec>
    DeviceBoxTree(Exec& exec, std::span<const std::uint32_t> order) : item_(order) {
        if (order.size() > kMaxItems) throw DeviceError("more boxes than a tree on the device can store");
        auto count = static_cast<std::uint32_t>(order.size());
        do {
            count = (count + kWidth - 1) / kWidth;
            first_[level_count_ + 1] = first_[level_count_] + count;
            ++level_count_;
        } while (count > 1);
        groups_ = exec.template array<BoxGroup>(first_[level_count_]);
    }

    /// item by index in level 0
    COPPICE_HOST_DEVICE std::span<const std::uint32_t> items() const { return item_; }
    COPPICE_HOST_DEVICE std::uint32_t level_count() const {
        return level_count_;
    }  ///< number of levels of groups
    /// Level 0 contains the boxes of the items in order; group i of a level is inside box i of the level
    /// above.
    COPPICE_HOST_DEVICE std::span<BoxGroup> level(std::uint32_t l) const {
        return groups_.subspan(first_[l], first_[l + 1] - first_[l]);
    }

    /// Calls visit(item) for all items with boxes that overlap or touch the given one, in the order of
    /// BoxTree, until visit returns false.
    template <class Visit>
    COPPICE_HOST_DEVICE void visit_overlapping(const Box3& box, const Visit& visit) const {
        visit_overlapping(box, {0, static_cast<std::uint32_t>(item_.size())}, visit);
    }
    /// Visits only items in a range of indices.
    template <class Visit>
    COPPICE_HOST_DEVICE void visit_overlapping(const Box3& box, PlaceRange places, const Visit& visit) const {
        if (places.begin == places.end) return;
        // Byte l: the boxes of the current group of level l that remain to be visited.
        std::uint64_t pending = find_hits(level_count_ - 1, 0, box, places);
        const std::uint32_t top = level_count_ - 1;
        pending <<= 8 * top;
        for (std::uint32_t l = top, group = 0; pending != 0;) {
            const auto hits = static_cast<std::uint32_t>(pending >> (8 * l)) & 0xff;
            if (hits == 0) {
                ++l;
                group /= kWidth;
                continue;
            }
            const std::uint32_t i = kWidth * group + lowest_bit(hits);
            pending &= pending - 1;  // levels below are done, so the lowest bit belongs to this level
            if (l > 0) {
                group = i;
                --l;
                pending |= std::uint64_t{find_hits(l, group, box, places)} << (8 * l);
            } else if (!visit(item_[i])) {
                return;
            }
        }
    }

  private:
    /// Returns the boxes of a group that overlap `box` and contain indices of the range; at least one index
    /// must be below the group.
    COPPICE_HOST_DEVICE std::uint32_t find_hits(std::uint32_t l, std::uint32_t group, const Box3& box,
                                                PlaceRange places) const {
        const std::uint32_t begin = kWidth * group;
        const std::uint32_t first = places.begin >> (3 * l), last = (places.end - 1) >> (3 * l);
        const std::uint32_t skipped = first > begin ? first - begin : 0;
        const std::uint32_t left = last - begin < kWidth - 1 ? kWidth - 1 - (last - begin) : 0;
        return groups_[first_[l] + group].overlapping(box) & (0xffu << skipped) & (0xffu >> left);
    }
    COPPICE_HOST_DEVICE static std::uint32_t lowest_bit(std::uint32_t bits) {
#ifdef __CUDA_ARCH__
        return static_cast<std::uint32_t>(__ffs(static_cast<int>(bits)) - 1);
#else
        return static_cast<std::uint32_t>(std::countr_zero(bits));
#endif
    }

    std::span<const std::uint32_t> item_;
    std::span<BoxGroup> groups_;  ///< sorted by level
    std::array<std::uint32_t, kMaxLevels + 1> first_{};
    std::uint32_t level_count_ = 0;
};

/// Computes in out[i] the bounding box of every out.size()-th box starting at i.
struct BoundBoxes {
    std::span<const Box3> boxes;
    std::span<Box3> out;
    COPPICE_HOST_DEVICE void operator()(std::uint32_t i) const {
        Box3 all;
        for (std::size_t k = i; k < boxes.size(); k += out.size()) all.extend(boxes[k]);
        out[i] = all;
    }
};

/// Computes the sorting keys of boxes.
struct EncodeBoxes {
    std::span<const Box3> boxes;
    std::span<const Box3> all;  ///< one box that contains them
    std::span<std::uint64_t> code;
    std::span<std::uint32_t> item;
    COPPICE_HOST_DEVICE void operator()(std::uint32_t i) const {
        code[i] = box_code(box_grid(all[0]), boxes[i]);
        item[i] = i;
    }
};

/// Computes the surface of each item for a common order of several surfaces: see sort_by_surface().
struct KeySurfaces {
    std::span<const std::uint32_t> first;  ///< first item of each surface, plus the end
    std::span<const std::uint32_t> item;
    std::span<std::uint32_t> key;
    COPPICE_HOST_DEVICE void operator()(std::uint32_t i) const { key[i] = find_row(first, item[i]); }
};

/// Fills groups with the boxes of the items.
struct GroupItems {
    std::span<const Box3> boxes;
    std::span<const std::uint32_t> item;
    std::span<BoxGroup> groups;
    COPPICE_HOST_DEVICE void operator()(std::uint32_t g) const {
        BoxGroup group;
        for (std::uint32_t k = 0; k < BoxGroup::kWidth; ++k) {
            const std::uint32_t place = BoxGroup::kWidth * g + k;
            group.set(k, place < item.size() ? boxes[item[place]] : Box3{});
        }
        groups[g] = group;
    }
};

/// Fills groups with the bounding boxes of the groups of the level below.
struct GroupGroups {
    std::span<const BoxGroup> below;
    std::span<BoxGroup> groups;
    COPPICE_HOST_DEVICE void operator()(std::uint32_t g) const {
        BoxGroup group;
        for (std::uint32_t k = 0; k < BoxGroup::kWidth; ++k) {
            const std::uint32_t i = BoxGroup::kWidth * g + k;
            group.set(k, i < below.size() ? below[i].bounds() : Box3{});
        }
        groups[g] = group;
    }
};

/// Fills the upper levels in one launch, because they are small.
struct GroupTop {
    static constexpr bool kIsWide = true;

    DeviceBoxTree tree;
    std::uint32_t from;  ///< the lowest of them
    template <class Group>
    COPPICE_HOST_DEVICE void operator()(std::uint32_t, const Group& group) const {
        for (std::uint32_t l = from; l < tree.level_count(); ++l) {
            const GroupGroups step{tree.level(l - 1), tree.level(l)};
            group.each(static_cast<std::uint32_t>(step.groups.size()), step);
        }
    }
};

/// Computes the order of boxes along a Morton curve, one number for each: the order of a BoxTree. Boxes must
/// be finite and not empty.
template <class Exec>
void order_boxes(Exec& exec, std::span<const Box3> boxes, std::span<std::uint32_t> order) {
    constexpr std::size_t kShare = 64;  // boxes per thread
    const auto before = exec.mark();
    std::span<const Box3> all = boxes;
    do {
        const std::span<Box3> fewer = exec.template array<Box3>((all.size() + kShare - 1) / kShare);
        exec.each("bound boxes", fewer.size(), BoundBoxes{all, fewer});
        all = fewer;
    } while (all.size() > 1);
    const auto code = exec.template array<std::uint64_t>(boxes.size());
    exec.each("encode boxes", boxes.size(), EncodeBoxes{boxes, all, code, order});
    exec.sort_pairs(code, order, 3 * kBoxCodeBits);
    exec.rewind(before);
}

/// Sorts the order by surface, so that items of one surface occupy the indices equal to their range of
/// numbers. The order within a surface is preserved.
template <class Exec>
void sort_by_surface(Exec& exec, std::span<const std::uint32_t> first, std::span<std::uint32_t> order) {
    const auto before = exec.mark();
    const auto key = exec.template array<std::uint32_t>(order.size());
    exec.each("key surfaces", order.size(), KeySurfaces{first, order, key});
    exec.sort_pairs(key, order, std::bit_width(first.size()));
    exec.rewind(before);
}

/// Computes order_boxes() in a new array.
template <class Exec>
std::span<const std::uint32_t> box_order(Exec& exec, std::span<const Box3> boxes) {
    const auto order = exec.template array<std::uint32_t>(boxes.size());
    order_boxes(exec, boxes, order);
    return order;
}

/// Creates the tree of boxes in a given order: that of box_order(), or of earlier positions of the boxes,
/// which makes queries slower but not incorrect.
template <class Exec>
DeviceBoxTree box_tree(Exec& exec, std::span<const Box3> boxes, std::span<const std::uint32_t> order) {
    constexpr std::size_t kTop = 1024;  // groups of a level that one block fills quickly
    const DeviceBoxTree tree(exec, order);
    exec.each("group items", tree.level(0).size(), GroupItems{boxes, order, tree.level(0)});
    std::uint32_t l = 1;
    for (; l < tree.level_count() && tree.level(l).size() > kTop; ++l) {
        exec.each("group groups", tree.level(l).size(), GroupGroups{tree.level(l - 1), tree.level(l)});
    }
    if (l < tree.level_count()) exec.groups("group top", 1, GroupTop{tree, l});
    return tree;
}

}  // namespace coppice::cuda
