#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <vector>

#include "coppice/base/box.h"
#include "coppice/base/kernel/round_cone.h"
#include "coppice/spatial/box_tree.h"

namespace coppice::compose_internal {

/// Index of the segments of a growing tree by bounding box. Recently added segments are searched linearly and
/// are moved to a box tree when there are many.
class PlacedSegments {
  public:
    /// Adds a segment. `name` identifies it; the box encloses the cone, enlarged for the search.
    void add(std::uint32_t name, const RoundCone& cone, const Box3& box) {
        names_.push_back(name);
        cones_.push_back(cone);
        boxes_.push_back(box);
        if (boxes_.size() - indexed_ > kLoose + boxes_.size() / kShare) index();
    }

    /// Restricts the following queries to boxes inside this one.
    void look_within(const Box3& all) {
        near_.clear();
        for (std::size_t i = indexed_; i < boxes_.size(); ++i) {
            if (boxes_[i].overlaps(all)) near_.push_back(i);
        }
    }

    /// Calls visit(name, cone) for the segments with boxes that overlap `box`, until it returns false.
    template <class Visit>
    void visit_overlapping(const Box3& box, const Visit& visit) const {
        bool goes_on = true;
        const auto look = [&](std::size_t i) { return goes_on = visit(names_[i], cones_[i]); };
        if (tree_) tree_->visit_overlapping(box, look);
        for (std::size_t k = 0; k < near_.size() && goes_on; ++k) {
            if (boxes_[near_[k]].overlaps(box)) look(near_[k]);
        }
    }

  private:
    static constexpr std::size_t kLoose = 1000, kShare = 10;

    void index() {
        tree_.emplace(boxes_, Context{.threads = 1});
        indexed_ = boxes_.size();
    }

    std::vector<std::uint32_t> names_;
    std::vector<RoundCone> cones_;
    std::vector<Box3> boxes_;
    std::optional<BoxTree> tree_;  ///< contains the first `indexed_` boxes
    std::size_t indexed_ = 0;
    std::vector<std::size_t> near_;  ///< other segments that overlap the query region
};

}  // namespace coppice::compose_internal
