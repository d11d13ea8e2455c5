#pragma once

#include <cstdint>
#include <vector>

#include "coppice/animate/pose.h"
#include "coppice/base/context.h"
#include "coppice/skeleton/skeleton.h"

namespace coppice::pipeline_internal {

/// The nodes of a skeleton that was made of another one, by preparing and grafting, on that one's segments,
/// so that they follow its poses.
class NodeBinding {
  public:
    /// O(n log n).
    NodeBinding(const Skeleton& skeleton, const Skeleton& made, const Context& ctx);

    /// The nodes of what was made, in a pose of the skeleton; turns are of the segments that end at them.
    Pose follow(const Skeleton& skeleton, const Skeleton& made, const Pose& pose) const;

    /// The node of the skeleton on whose segment a node lies.
    NodeId segment(NodeId made) const { return place_[made.index()].segment; }

  private:
    struct Place {
        NodeId segment;  ///< of the skeleton, by its child node
        double t = 1;    ///< where on it
        Vec3d offset;    ///< [m] from there, at rest
        NodeId turn;     ///< the segment with which that turns that ends at the node
    };

    std::vector<Place> place_;
};

}  // namespace coppice::pipeline_internal
