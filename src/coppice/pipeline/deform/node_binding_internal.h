#pragma once

#include <cstdint>
#include <vector>

#include "coppice/base/context.h"
#include "coppice/edit/animate/pose.h"
#include "coppice/skeleton/skeleton.h"

namespace coppice::pipeline_internal {

/// Binds the nodes of a skeleton that was derived from another one, by preparation and grafting, to the
/// segments of the original, so that they follow its poses.
class NodeBinding {
  public:
    /// O(n log n).
    NodeBinding(const Skeleton& skeleton, const Skeleton& made, const Context& ctx);

    /// Returns the nodes of the derived skeleton in a pose of the original; rotations belong to the segments
    /// that end at them.
    Pose follow(const Skeleton& skeleton, const Skeleton& made, const Pose& pose) const;

    /// Returns the node of the original skeleton with the segment that contains a node.
    NodeId segment(NodeId made) const { return place_[made.index()].segment; }

  private:
    struct Place {
        NodeId segment;  ///< of the original skeleton, by its child node
        double t = 1;    ///< parameter on it
        Vec3d offset;    ///< [m] from there, at rest
        NodeId turn;     ///< the segment that rotates the one that ends at the node
    };

    std::vector<Place> place_;
};

}  // namespace coppice::pipeline_internal
