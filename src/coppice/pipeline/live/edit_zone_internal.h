#pragma once

#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include "coppice/base/box.h"
#include "coppice/base/context.h"
#include "coppice/skeleton/skeleton.h"

namespace coppice::pipeline_internal {

/// Index of the nodes of a skeleton by stable id.
class NodeIndex {
  public:
    explicit NodeIndex(const Skeleton& s);
    /// Returns the node; none if there is no node with this id.
    NodeId operator[](StableId id) const {
        return id.index() < node_.size() ? node_[id.index()] : NodeId::none();
    }

  private:
    std::vector<NodeId> node_;
};

/// [m] Returns the box of the segment that ends at a node, or of a root, with a margin of this number of
/// radii.
Box3 box_about(const Skeleton& s, NodeId n, float radii);

/// The nodes of the current tree that an edit touches, and the previous and current locations of segments.
struct Touched {
    std::vector<NodeId> nodes;
    std::vector<StableId> ids;  ///< of these nodes
    std::vector<Box3> boxes;    ///< [m] of segments with their influence
};

/// Returns the touched nodes if the given nodes have been added, removed or changed.
Touched touched_by(std::span<const StableId> changed, const Skeleton& before, const NodeIndex& at_before,
                   const Skeleton& now, const NodeIndex& at_now);

/// The part of a tree around an edit for which a surface can be built that is identical, in its middle, to
/// that of the whole tree.
struct EditZone {
    /// The nodes near the edit, all nodes between them and the roots, and the children of all these, in their
    /// order.
    Skeleton part;
    /// Per node of the part: number of branch nodes between it and the touched nodes; kFar: too many.
    std::vector<std::uint8_t> level;

    static constexpr std::uint8_t kFar = 255;
};

/// Returns the zone in which nodes up to `trusted` levels are surrounded by everything that their surface
/// depends on; nullopt if that is most of the tree. O(n) in the tree, with a small constant.
std::optional<EditZone> edit_zone(const Skeleton& now, const Touched& touched, std::uint8_t trusted,
                                  const Context& ctx);

}  // namespace coppice::pipeline_internal
