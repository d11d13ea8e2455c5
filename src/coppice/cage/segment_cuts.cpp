#include <cmath>

#include "coppice/cage/segment_cuts_internal.h"

namespace coppice::cage_internal {
namespace {

constexpr float kSnap = 0.5f;   // [radii] a point closer to a node or a cut than this is moved to it
constexpr float kSame = 1e-4f;  // difference of parameters of equal points

}  // namespace

std::uint32_t place_of_cut(const AxisGeometry& axes, AxisPoint p, SegmentCuts& cuts) {
    const Skeleton& s = axes.skeleton;
    if (p.t <= 0 && !axes.axes.is_first(p.segment)) return s.parent(p.segment).index();
    if (p.t >= 1) return p.segment.index();
    for (std::uint32_t c = cuts.newest[p.segment.index()]; c != kNoIndex; c = cuts.cuts[c].next) {
        if (std::abs(cuts.cuts[c].point.t - p.t) < kSame) return s.size() + c;
    }
    const auto c = static_cast<std::uint32_t>(cuts.cuts.size());
    cuts.cuts.push_back({p, cuts.newest[p.segment.index()]});
    cuts.newest[p.segment.index()] = c;
    return s.size() + c;
}

std::uint32_t place_near(const AxisGeometry& axes, VisibleRange visible, AxisPoint p, SegmentCuts& cuts) {
    const NodeId n = p.segment;
    const std::uint32_t nodes = axes.skeleton.size();
    const float size = axes.axes.arc(n) - axes.start(n);
    float nearest = kSnap * axes.radius(p);
    std::uint32_t place = kNoIndex;
    const auto consider = [&](float t, std::uint32_t candidate) {
        const float off = std::abs(t - p.t) * size;
        if (off <= nearest) {
            nearest = off;
            place = candidate;
        }
    };
    if (visible.from <= 0) consider(0, axes.skeleton.parent(n).index());
    if (visible.to >= 1) consider(1, n.index());
    cuts.for_each(n, [&](std::uint32_t c, float t) {
        if (t >= visible.from - kSame && t <= visible.to + kSame) consider(t, nodes + c);
    });
    return place != kNoIndex ? place : place_of_cut(axes, p, cuts);
}

}  // namespace coppice::cage_internal
