#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "coppice/cage/axis_points_internal.h"
#include "coppice/cage/crossings_internal.h"
#include "coppice/cage/graft.h"
#include "coppice/cage/segment_cuts_internal.h"

namespace coppice::cage_internal {

/// A section of an axis inside another branch.
struct EnclosedInterval {
    float from, to;  ///< [m] along the axis
    NodeId parent;
    float parent_from, parent_t;  ///< parameters on the parent branch at its beginning and end
    float approach;               ///< cosine of the angle of entry, >= 0
};

/// A section of an axis that gets a tube.
struct VisibleSection {
    float from, to;                   ///< [m] along the axis
    std::uint32_t attach = kNoIndex;  ///< place at which it begins; none: the beginning of the axis
    std::uint32_t start = kNoIndex;   ///< place of `from`, if attached
    /// [m] where the axis is so deep in the branch that the section enters that it is not visible; 0: it ends
    /// at its tip
    float resume = 0;
    std::uint32_t join = kNoIndex;  ///< place of another branch in which it ends, if any
    std::uint32_t end = kNoIndex;   ///< place of `resume`, if joined
};

struct AxisPlan {
    std::vector<EnclosedInterval> enclosed;
    std::vector<VisibleSection> sections;

    /// Returns whether a tube contains the axis at an arc length.
    bool is_visible(float arc) const;
    /// Returns the section that ends before an arc length within the short gap after it; nullptr if there is
    /// none.
    const VisibleSection* section_ended_before(float arc) const;

  private:
    const VisibleSection* last_section_before(float arc) const;
};

/// The sections of axes that get tubes, and the places at which these begin.
struct GraftPlan {
    std::vector<VisibleRange> visible;   ///< by segment
    std::vector<std::uint32_t> of_axis;  ///< by axis: index into `plans`; kNoIndex: the whole axis
    std::vector<AxisPlan> plans;
    std::vector<AxisPoint> enclosed_at;  ///< by node: point of the enclosing branch; no segment: none
    SegmentCuts cuts;
    GraftReport report;
};

/// Plans axis by axis, in their order: thick before thin.
GraftPlan plan_grafts(const AxisGeometry& axes, const Enclosure& enclosure, SectionEnd end,
                      const Context& ctx);

/// Returns the closest point of the branch that encloses a point of an axis; no segment if there is none.
AxisPoint parent_at(const AxisGeometry& axes, const Enclosure& enclosure, const GraftPlan& plan,
                    std::uint32_t axis, float arc);

}  // namespace coppice::cage_internal
