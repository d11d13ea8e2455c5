#include "coppice/skeleton/skeleton.h"

#include <fmt/format.h>

#include <algorithm>

#include "coppice/base/error.h"

namespace coppice {
namespace {

void check_unique(std::vector<StableId> ids) {
    std::ranges::sort(ids);
    const auto twin = std::ranges::adjacent_find(ids);
    if (twin != ids.end()) {
        throw InvalidInput(
            fmt::format("the id {} is used by two nodes; give every node a unique id", twin->index()));
    }
}

}  // namespace

Skeleton::Skeleton(std::vector<NodeId> parent, std::vector<Vec3> position, std::vector<float> radius,
                   Vec3d origin, std::vector<StableId> stable_ids)
    : parent_(std::move(parent)),
      position_(std::move(position)),
      radius_(std::move(radius)),
      origin_(origin),
      stable_id_(std::move(stable_ids)) {
    COPPICE_ASSERT(position_.size() == size() && radius_.size() == size());
    COPPICE_ASSERT(stable_id_.empty() || stable_id_.size() == size());
    if (size() == 0) throw InvalidInput("the skeleton has no nodes");
    check_unique(stable_id_);
    first_child_.assign(size() + 1, 0);
    leader_ = Column<NodeId, NodeId>(size());
    for (const NodeId n : nodes(*this)) {
        const NodeId p = parent_[n];
        if (p && p >= n) throw InvalidInput(fmt::format("node {} comes before its parent", n.index()));
        if (!is_finite(position_[n]))
            throw InvalidInput(fmt::format("node {} has no finite position", n.index()));
        if (!(radius_[n] > 0) || !std::isfinite(radius_[n])) {
            throw InvalidInput(fmt::format("node {} has no finite radius above 0", n.index()));
        }
        if (!p) {
            ++tree_count_;
            continue;
        }
        ++first_child_[p.index() + 1];
        if (!leader_[p] || radius_[n] > radius_[leader_[p]]) leader_[p] = n;
    }
    for (std::uint32_t i = 0; i < size(); ++i) first_child_[i + 1] += first_child_[i];
    child_.resize(first_child_.back());
    std::vector<std::uint32_t> fill(first_child_.begin(), first_child_.end() - 1);
    for (const NodeId n : nodes(*this)) {
        if (const NodeId p = parent_[n]) child_[fill[p.index()]++] = n;
    }
}

std::span<const NodeId> Skeleton::children(NodeId n) const {
    const auto first = first_child_[n.index()];
    return {child_.data() + first, first_child_[n.index() + 1] - first};
}

Segment Skeleton::segment(NodeId n) const {
    const NodeId p = parent_[n];
    COPPICE_ASSERT(p);
    return {position_[p], position_[n], leader_[p] == n ? radius_[p] : radius_[n], radius_[n]};
}

Box3 Skeleton::bounds() const {
    Box3 box;
    for (const NodeId n : nodes(*this)) box.extend(capsule_box(position_[n], position_[n], radius_[n]));
    return box;
}

}  // namespace coppice
