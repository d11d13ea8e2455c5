#include <algorithm>

#include "coppice/foliage/wood_internal.h"
#include "coppice/skeleton/segment_cone.h"

namespace coppice::foliage_internal {
namespace {

std::vector<NodeId> find_thick(const Skeleton& s, float max_radius) {
    std::vector<NodeId> out;
    for (const NodeId n : nodes(s)) {
        if (s.is_root(n)) continue;
        const Segment segment = s.segment(n);
        if (std::max(segment.radius_a, segment.radius_b) > max_radius) out.push_back(n);
    }
    return out;
}

std::vector<BasicRoundCone<float>> make_cones(const Skeleton& s, const std::vector<NodeId>& ends) {
    std::vector<BasicRoundCone<float>> out;
    for (const NodeId n : ends) out.push_back(round_cone<float>(s.segment(n)));
    return out;
}

std::vector<Box3> make_boxes(const std::vector<BasicRoundCone<float>>& cones) {
    std::vector<Box3> out;
    for (const BasicRoundCone<float>& cone : cones)
        out.push_back(capsule_box(cone.a, cone.b(), std::max(cone.radius_a, cone.radius_b())));
    return out;
}

}  // namespace

Wood::Wood(const Skeleton& skeleton, float max_radius, const Context& ctx)
    : nodes_(find_thick(skeleton, max_radius)),
      cones_(make_cones(skeleton, nodes_)),
      boxes_(make_boxes(cones_), ctx) {}

void Wood::find_near(const Box3& box, std::vector<std::uint32_t>& near) const {
    near.clear();
    boxes_.visit_overlapping(box, [&](std::uint32_t i) { near.push_back(i); });
}

bool Wood::contains(const LeafPoints& leaf, std::span<const std::uint32_t> near) const {
    return std::ranges::any_of(near, [&](std::uint32_t i) {
        const auto depth = [&](Vec3 p) { return -cones_[i].closest_point(p).signed_distance(); };
        return (nodes_[i] != leaf.node && depth(leaf.attachment) > leaf.depth) ||
               std::ranges::any_of(leaf.midrib, [&](Vec3 p) { return depth(p) > -leaf.clearance; });
    });
}

}  // namespace coppice::foliage_internal
