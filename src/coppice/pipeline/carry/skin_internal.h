#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include "coppice/animate/pose.h"
#include "coppice/base/column.h"
#include "coppice/base/context.h"
#include "coppice/skeleton/skeleton.h"

namespace coppice::pipeline_internal {

/// The segments that move a vertex, each named by its child node, and how much; those without weight repeat
/// the first.
struct Influence {
    std::array<std::uint32_t, 4> segment;
    std::array<float, 4> weight;
};

/// Shares of the segments about places on a skeleton: those of a window along the axis, about a radius to
/// both sides. A lateral begins where it leaves the bark of its host; what lies before moves with that.
class AxisWindow {
  public:
    explicit AxisWindow(const Skeleton& skeleton);

    /// About the place of a segment that is nearest to a point.
    Influence at(NodeId segment, Vec3 point) const;

    /// Of the segments at the ends of one, itself included, that to which a point is nearest in radii.
    NodeId nearest_beside(NodeId segment, Vec3 point) const;

  private:
    bool is_lateral(NodeId n) const;
    float begin(NodeId n) const;

    const Skeleton& skeleton_;
    std::vector<float> length_;  ///< [m] by segment
};

/// How a segment moves what it carries.
struct SegmentMove {
    Vec3 from, to;              ///< [m] its beginning, at rest and in the pose
    std::array<Vec3, 3> along;  ///< columns of the turn, with the stretch along the axis
    std::array<float, 4> turn;  ///< w, x, y, z
    float growth = 1;           ///< of radii
};

/// Moves of all segments from one skeleton to another of the same nodes, with the segments' turns.
std::vector<SegmentMove> segment_moves(const Skeleton& rest, const Skeleton& now,
                                       std::span<const Rotation> turns);

/// Where a segment takes a point.
Vec3 moved(const SegmentMove& move, Vec3 rest);

/// Moves anchors and the vertices about them.
void carry_points(std::span<const Influence> influences, std::span<const SegmentMove> moves,
                  std::span<const Vec3> rest_anchors, std::span<const Vec3> rest_positions,
                  std::span<Vec3> anchors, std::span<Vec3> positions, const Context& ctx);

}  // namespace coppice::pipeline_internal
