#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include "coppice/base/column.h"
#include "coppice/base/context.h"
#include "coppice/edit/animate/pose.h"
#include "coppice/skeleton/skeleton.h"

namespace coppice::pipeline_internal {

/// The segments that move a vertex, each identified by its child node, and their weights; entries without
/// weight repeat the first.
struct Influence {
    std::array<std::uint32_t, 4> segment;
    std::array<float, 4> weight;
};

/// Weights of the segments at positions on a skeleton: those within a window along the axis, about one radius
/// to both sides. A lateral begins where it leaves the bark of its parent branch; the section before that
/// moves with the parent branch.
class AxisWindow {
  public:
    explicit AxisWindow(const Skeleton& skeleton);

    /// Returns the influence around the point of a segment that is closest to a point.
    Influence at(NodeId segment, Vec3 point) const;

    /// Returns the segment that is closest to a point, in radii, of a segment and those at its ends.
    NodeId nearest_adjacent(NodeId segment, Vec3 point) const;

  private:
    bool is_lateral(NodeId n) const;
    float begin(NodeId n) const;

    const Skeleton& skeleton_;
    std::vector<float> length_;  ///< [m] by segment
};

/// Transformation of the points that a segment moves.
struct SegmentMove {
    Vec3 from, to;              ///< [m] its beginning, at rest and in the pose
    std::array<Vec3, 3> along;  ///< columns of the rotation, with the stretch along the axis
    std::array<float, 4> turn;  ///< w, x, y, z
    float growth = 1;           ///< scale factor of radii
};

/// Returns the transformations of all segments from one skeleton to another of the same nodes, with the
/// rotations of the segments.
std::vector<SegmentMove> segment_moves(const Skeleton& rest, const Skeleton& now,
                                       std::span<const Rotation> turns);

/// Returns a point moved by a segment.
Vec3 moved(const SegmentMove& move, Vec3 rest);

/// Moves anchors and their vertices.
void deform_points(std::span<const Influence> influences, std::span<const SegmentMove> moves,
                   std::span<const Vec3> rest_anchors, std::span<const Vec3> rest_positions,
                   std::span<Vec3> anchors, std::span<Vec3> positions, const Context& ctx);

}  // namespace coppice::pipeline_internal
