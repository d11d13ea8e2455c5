#pragma once

#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include "coppice/base/box.h"
#include "coppice/base/context.h"
#include "coppice/skeleton/skeleton.h"

namespace coppice::pipeline_internal {

/// Where each node of a skeleton is, by the number that it keeps.
class NodeIndex {
  public:
    explicit NodeIndex(const Skeleton& s);
    /// The node; none where there is none of this number.
    NodeId operator[](StableId id) const {
        return id.index() < node_.size() ? node_[id.index()] : NodeId::none();
    }

  private:
    std::vector<NodeId> node_;
};

/// [m] The box of the segment that ends at a node, or of a root, with so many radii about it.
Box3 box_about(const Skeleton& s, NodeId n, float radii);

/// What an edit touched: nodes of the tree as it is now, and where segments were before or are now.
struct Touched {
    std::vector<NodeId> nodes;
    std::vector<StableId> ids;  ///< of these
    std::vector<Box3> boxes;    ///< [m] of segments with their influence
};

/// What is touched when the named nodes have come, gone or changed.
Touched touched_by(std::span<const StableId> changed, const Skeleton& before, const NodeIndex& at_before,
                   const Skeleton& now, const NodeIndex& at_now);

/// The part of a tree about an edit, for which a surface can be made that is the same, in its middle, as that
/// of the whole tree.
struct EditZone {
    /// The nodes near the edit, all on the way to the roots, and the children of all these, in their order.
    Skeleton part;
    /// Per node of the part: how many branch nodes lie between it and what the edit touched; kFar: too many.
    std::vector<std::uint8_t> level;

    static constexpr std::uint8_t kFar = 255;
};

/// The zone in which nodes up to `trusted` levels have all about them that their surface depends on; none
/// where that is most of the tree. O(n) in the tree, with a small constant.
std::optional<EditZone> edit_zone(const Skeleton& now, const Touched& touched, std::uint8_t trusted,
                                  const Context& ctx);

}  // namespace coppice::pipeline_internal
