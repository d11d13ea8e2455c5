#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include "coppice/base/context.h"
#include "coppice/base/kernel/round_cone.h"
#include "coppice/base/vec.h"
#include "coppice/skeleton/skeleton.h"
#include "coppice/spatial/box_tree.h"

namespace coppice::foliage_internal {

/// The points of a leaf that are compared with wood.
struct LeafPoints {
    Vec3 attachment;             ///< [m]
    NodeId node;                 ///< end of the segment to which the leaf is attached
    float depth = 0;             ///< [m] accepted depth of the attachment in other segments
    std::array<Vec3, 3> midrib;  ///< [m] along the leaf, up to its tip
    float clearance = 0;         ///< [m] distance that the midrib must have from wood
};

/// The segments of a skeleton that leaves must not enter.
class Wood {
  public:
    /// Takes the segments with an end thicker than `max_radius` [m].
    Wood(const Skeleton& skeleton, float max_radius, const Context& ctx);

    /// Replaces `near` by the segments with boxes that overlap the given one.
    void find_near(const Box3& box, std::vector<std::uint32_t>& near) const;

    /// Returns whether a leaf is attached inside of one of the segments, or has a point of its midrib in
    /// one or closer than the clearance.
    bool contains(const LeafPoints& leaf, std::span<const std::uint32_t> near) const;

  private:
    std::vector<NodeId> nodes_;
    std::vector<BasicRoundCone<float>> cones_;
    BoxTree boxes_;
};

}  // namespace coppice::foliage_internal
