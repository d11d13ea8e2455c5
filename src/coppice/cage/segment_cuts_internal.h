#pragma once

#include <cstdint>
#include <vector>

#include "coppice/base/id.h"
#include "coppice/cage/axis_points_internal.h"

namespace coppice::cage_internal {

/// The range of a segment that gets a tube.
struct VisibleRange {
    float from = 0, to = 1;
    bool empty() const { return !(from < to); }
};

/// Nodes inserted into segments. A place is the index of a node, or that of a cut plus the number of nodes.
struct SegmentCuts {
    struct Cut {
        AxisPoint point;
        std::uint32_t next;  ///< of the same segment
    };
    std::vector<Cut> cuts;
    std::vector<std::uint32_t> newest;  ///< by segment

    /// Calls visit(cut, t) for the cuts of a segment, the newest first.
    template <class Visit>
    void for_each(NodeId segment, const Visit& visit) const {
        for (std::uint32_t c = newest[segment.index()]; c != kNoIndex; c = cuts[c].next)
            visit(c, cuts[c].point.t);
    }
};

/// Returns the place of a point: an existing node or cut, or a new cut.
std::uint32_t place_of_cut(const AxisGeometry& axes, AxisPoint p, SegmentCuts& cuts);

/// The same, but a close node or cut, within the range of the segment that gets a tube, is accepted.
std::uint32_t place_near(const AxisGeometry& axes, VisibleRange visible, AxisPoint p, SegmentCuts& cuts);

}  // namespace coppice::cage_internal
