#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "coppice/cage/axis_points_internal.h"
#include "coppice/cage/crossings_internal.h"
#include "coppice/cage/graft.h"
#include "coppice/cage/segment_cuts_internal.h"

namespace coppice::cage_internal {

/// A part of an axis that lies inside another branch.
struct EnclosedInterval {
    float from, to;  ///< [m] along the axis
    NodeId host;
    float host_from, host_t;  ///< where on the host it begins and ends
    float approach;           ///< the cosine at which it enters, >= 0
};

/// A part of an axis that gets a tube.
struct VisiblePiece {
    float from, to;                   ///< [m] along the axis
    std::uint32_t attach = kNoIndex;  ///< the place it springs from; none: the beginning of the axis
    std::uint32_t start = kNoIndex;   ///< the place of `from`, where attached
    /// [m] where the axis lies so deep in what the piece has met that nothing shows; 0: it ends at its tip
    float resume = 0;
    std::uint32_t join = kNoIndex;  ///< the place of another branch in which it ends, if any
    std::uint32_t end = kNoIndex;   ///< the place of `resume`, where joined
};

struct AxisPlan {
    std::vector<EnclosedInterval> enclosed;
    std::vector<VisiblePiece> pieces;

    /// Whether a tube holds the axis at an arc length.
    bool is_visible(float arc) const;
    /// The piece that ends before an arc length which lies in the little that is left out there; or none.
    const VisiblePiece* piece_ended_before(float arc) const;

  private:
    const VisiblePiece* last_piece_before(float arc) const;
};

/// Which parts of which axes get tubes, and where these spring from.
struct GraftPlan {
    std::vector<VisibleRange> visible;   ///< by segment
    std::vector<std::uint32_t> of_axis;  ///< by axis: of `plans`; kNoIndex: the whole axis, at its own node
    std::vector<AxisPlan> plans;
    std::vector<AxisPoint> enclosed_at;  ///< by node: where in another branch it lies; no segment: in none
    SegmentCuts cuts;
    GraftReport report;
};

/// Plans axis by axis, in their order: thick before thin.
GraftPlan plan_grafts(const AxisGeometry& axes, const Enclosure& enclosure, PieceEnd end, const Context& ctx);

/// The nearest point of the branch that hides a point of an axis; no segment where nothing does.
AxisPoint host_at(const AxisGeometry& axes, const Enclosure& enclosure, const GraftPlan& plan,
                  std::uint32_t axis, float arc);

}  // namespace coppice::cage_internal
