#pragma once

#include <algorithm>
#include <span>

#include "coppice/cage/axes_internal.h"
#include "coppice/skeleton/segment_cone.h"

namespace coppice::cage_internal {

/// A point of an axis: on the segment that ends at a node, with t = 0 at its parent and 1 at the node.
struct AxisPoint {
    NodeId segment;
    float t = 0;
};

/// Positions along the axes of a skeleton, by arc length; refers to both.
struct AxisGeometry {
    const Skeleton& skeleton;
    const Axes& axes;

    /// [m] Returns the arc length at which the segment that ends at a node begins.
    float start(NodeId n) const { return axes.is_first(n) ? 0 : axes.arc(skeleton.parent(n)); }

    /// Returns the first node at or beyond an arc length, or the last node.
    std::span<const NodeId>::iterator first_node_at(std::span<const NodeId> chain, float arc) const {
        return std::lower_bound(chain.begin(), chain.end() - 1, arc,
                                [&](NodeId n, float a) { return axes.arc(n) < a; });
    }
    AxisPoint at(std::span<const NodeId> chain, float arc) const {
        const NodeId n = *first_node_at(chain, arc);
        const float from = start(n);
        return {n, std::clamp((arc - from) / std::max(axes.arc(n) - from, 1e-30f), 0.0f, 1.0f)};
    }
    Vec3 position(AxisPoint p) const { return round_cone<float>(skeleton.segment(p.segment)).point(p.t); }
    float radius(AxisPoint p) const { return round_cone<float>(skeleton.segment(p.segment)).radius(p.t); }
};

}  // namespace coppice::cage_internal
