#include "coppice/field/skeleton_segments.h"

#include "coppice/skeleton/segment_cone.h"

namespace coppice {
namespace {

// An end hidden in a thicker branch needs no extension.
RootEnd root_end(const Skeleton& s, NodeId n) {
    const NodeId p = s.parent(n);
    if (s.is_root(p)) return s.children(p).size() == 1 ? RootEnd::base : RootEnd::round;
    return s.leader(p) != n && s.radius(n) > s.radius(p) ? RootEnd::round : RootEnd::none;
}

}  // namespace

SkeletonSegments::SkeletonSegments(const Skeleton& skeleton, const SegmentBuilder& builder)
    : skeleton_(&skeleton), builder_(builder), direction_(skeleton.size(), Vec3{0, 0, 1}) {
    for (const NodeId n : nodes(skeleton)) find_direction(n, skeleton.positions());
}

void SkeletonSegments::follow(std::span<const std::uint32_t> moved, std::span<const Vec3> positions) {
    for (const std::uint32_t n : moved) find_direction(NodeId(n), positions);
}

void SkeletonSegments::find_direction(NodeId n, std::span<const Vec3> positions) {
    if (skeleton_->is_root(n)) return;
    const NodeId p = skeleton_->parent(n);
    const Vec3 axis = positions[n.index()] - positions[p.index()];
    const float l = length(axis);
    direction_[n.index()] = l > 0 ? axis / l : direction_[p.index()];
}

kernel::SegmentConstants<float> SkeletonSegments::build(NodeId n, std::span<const Vec3> positions) const {
    const Skeleton& s = *skeleton_;
    if (s.is_root(n)) {
        auto ball = builder_.build_ball(positions[n.index()], s.radius(n));
        if (!s.is_tip(n)) ball.weight = 0;
        return ball;
    }
    const NodeId p = s.parent(n);
    if (s.is_root(p) && s.leader(p) == n && is_ball(s, p))
        return builder_.build_ball(positions[p.index()], s.radius(p));
    Segment segment = s.segment(n);
    segment.a = positions[p.index()];
    segment.b = positions[n.index()];
    return builder_.build(segment, direction_[n.index()], s.is_tip(n), root_end(s, n));
}

}  // namespace coppice
