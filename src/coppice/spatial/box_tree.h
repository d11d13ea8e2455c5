#pragma once

#include <array>
#include <bit>
#include <cstdint>
#include <span>
#include <type_traits>
#include <vector>

#include "coppice/base/box.h"
#include "coppice/base/context.h"
#include "coppice/spatial/box_tree_kernel.h"

namespace coppice {

/// Hierarchy of boxes for all queries of this module. The items are sorted along a Morton curve, and each
/// node bounds eight consecutive boxes of the level below, so that the tree needs no pointers and does not
/// depend on the number of threads. Its shape depends only on the number of items: at most a dozen levels for
/// any arrangement of the boxes. A place is the index of an item in the sorted order. O(n).
class BoxTree {
  public:
    static constexpr std::uint32_t kWidth = BoxGroup::kWidth;  ///< number of boxes per parent box

    /// Builds the tree. Boxes must be finite and not empty.
    BoxTree(std::span<const Box3> boxes, const Context& ctx);

    std::uint32_t size() const { return static_cast<std::uint32_t>(item_.size()); }  ///< number of items
    /// Returns the index of the item at a place in the input span.
    std::uint32_t item(std::uint32_t place) const { return item_[place]; }
    /// Returns the number of levels; 0 without items.
    std::uint32_t level_count() const { return static_cast<std::uint32_t>(level_.size()); }
    /// Returns the boxes of a level. Level 0 contains the boxes of the items by place; box i of a level
    /// bounds boxes 8 i .. 8 i + 7 of the level below.
    std::span<const Box3> level(std::uint32_t l) const { return level_[l]; }

    /// Visits items from near to far: calls visit(item) for those with a `bound` of at most `limit`, which
    /// visit may reduce. bound(level, i) must not exceed its values for the boxes below box i of that level.
    template <class Bound, class Visit>
    void search(const Bound& bound, const double& limit, const Visit& visit) const {
        if (size() > 0) descend(level_count() - 1, 0, bound, limit, visit);
    }

    /// Returns the number of groups of kWidth places.
    std::uint32_t group_count() const { return (size() + kWidth - 1) / kWidth; }

    /// Calls visit(p, q) for all places p in a group and q > p with overlapping boxes; touching boxes
    /// overlap. A visit that returns false ends the search.
    template <class Visit>
    void overlaps(std::uint32_t group, const Visit& visit) const {
        if (level_count() > 1) overlaps_below(level_count() - 1, 0, Group(*this, group), visit);
    }

    /// Calls visit(item) for all items with boxes that overlap the given one; touching boxes overlap. A visit
    /// that returns false ends the search.
    template <class Visit>
    void visit_overlapping(const Box3& box, const Visit& visit) const {
        if (size() > 0) visit_below(level_count() - 1, 0, box, visit);
    }

    /// Returns whether the box of any item overlaps the given one; touching boxes overlap.
    bool meets(const Box3& box) const {
        bool found = false;
        visit_overlapping(box, [&](std::uint32_t) {
            found = true;
            return false;
        });
        return found;
    }

  private:
    /// Returns the range of boxes of level l below box `parent` of the level above.
    std::array<std::uint32_t, 2> children(std::uint32_t l, std::uint32_t parent) const {
        const auto count = static_cast<std::uint32_t>(level_[l].size());
        return {kWidth * parent, std::min(kWidth * parent + kWidth, count)};
    }

    template <class Bound, class Visit>
    void descend(std::uint32_t l, std::uint32_t parent, const Bound& bound, const double& limit,
                 const Visit& visit) const {
        struct Child {
            double bound;
            std::uint32_t index;
        };
        std::array<Child, kWidth> child;
        std::uint32_t n = 0;
        const auto [begin, end] = children(l, parent);
        for (std::uint32_t i = begin; i < end; ++i) {
            const double b = bound(l, i);
            if (!(b <= limit)) continue;
            std::uint32_t k = n++;
            for (; k > 0 && child[k - 1].bound > b; --k) child[k] = child[k - 1];
            child[k] = {b, i};
        }
        for (std::uint32_t k = 0; k < n && child[k].bound <= limit; ++k) {
            if (l == 0) {
                visit(item_[child[k].index]);
            } else {
                descend(l - 1, child[k].index, bound, limit, visit);
            }
        }
    }

    // Both return false if the search has ended.
    template <class Visit>
    bool visit_below(std::uint32_t l, std::uint32_t parent, const Box3& box, const Visit& visit) const {
        const auto [begin, end] = children(l, parent);
        for (std::uint32_t i = begin; i < end; ++i) {
            if (!level_[l][i].overlaps(box)) continue;
            if (l > 0) {
                if (!visit_below(l - 1, i, box, visit)) return false;
            } else if constexpr (std::is_same_v<std::invoke_result_t<Visit, std::uint32_t>, bool>) {
                if (!visit(item_[i])) return false;
            } else {
                visit(item_[i]);
            }
        }
        return true;
    }

    /// Group of places.
    struct Group {
        Group(const BoxTree& tree, std::uint32_t group)
            : bounds(tree.level_[1][group]), first(kWidth * group) {
            for (std::uint32_t i = 0; i < kWidth; ++i) {
                boxes.set(i, first + i < tree.size() ? tree.level_[0][first + i] : Box3{});
            }
        }

        Box3 bounds;
        std::uint32_t first;
        BoxGroup boxes;
    };

    template <class Visit>
    bool overlaps_below(std::uint32_t l, std::uint32_t parent, const Group& own, const Visit& visit) const {
        const auto [begin, end] = children(l, parent);
        // Boxes before the group have been processed already.
        const std::uint32_t first = l == 0 ? own.first + 1 : own.first >> (3 * l);
        for (std::uint32_t i = std::max(begin, first); i < end; ++i) {
            if (!level_[l][i].overlaps(own.bounds)) continue;
            if (l > 0) {
                if (!overlaps_below(l - 1, i, own, visit)) return false;
                continue;
            }
            std::uint32_t bits = own.boxes.overlapping(level_[0][i]);
            if (i - own.first < kWidth) bits &= (1u << (i - own.first)) - 1;
            for (; bits != 0; bits &= bits - 1) {
                const std::uint32_t p = own.first + static_cast<std::uint32_t>(std::countr_zero(bits));
                if constexpr (std::is_same_v<std::invoke_result_t<Visit, std::uint32_t, std::uint32_t>,
                                             bool>) {
                    if (!visit(p, i)) return false;
                } else {
                    visit(p, i);
                }
            }
        }
        return true;
    }

    std::vector<std::uint32_t> item_;
    std::vector<std::vector<Box3>> level_;
};

/// Returns the squared distance from a point to a box, 0 inside.
inline double distance_squared(const Box3& box, Vec3d p) {
    double sum = 0;
    for (int axis = 0; axis < 3; ++axis) {
        const double d = std::max({box.low[axis] - p[axis], 0.0, p[axis] - box.high[axis]});
        sum += d * d;
    }
    return sum;
}

/// Returns the squared distance between two boxes, 0 if they overlap.
inline double distance_squared(const Box3& a, const Box3& b) {
    double sum = 0;
    for (int axis = 0; axis < 3; ++axis) {
        const double d =
            std::max({double{a.low[axis]} - b.high[axis], 0.0, double{b.low[axis]} - a.high[axis]});
        sum += d * d;
    }
    return sum;
}

/// Extends a box to the smallest box in single precision that contains a point in double precision.
void extend_outward(Box3& box, Vec3d p);
/// Extends a box to one that contains the ball.
void extend_outward(Box3& box, Vec3d center, double radius);

}  // namespace coppice
