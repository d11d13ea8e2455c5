#pragma once

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <span>

#include "coppice/base/box.h"
#include "coppice/base/id.h"
#include "coppice/base/kernel/host_device.h"
#include "coppice/field/candidate_lists.h"
#include "coppice/field/kernel/segment_kernel.h"

namespace coppice {

/// Maximum number of competing segments, the nearest ones: a surface in contact on more sides has no room.
inline constexpr std::size_t kMaxCompetitors = 48;
/// Maximum number of segments examined by a search for competing segments.
inline constexpr std::size_t kMaxNear = 1024;

/// Returns the box of a region, from the box of its quads and their anchors and the radius of the segment
/// that identifies it.
COPPICE_HOST_DEVICE inline Box3 region_box(const Box3& quads, float radius) {
    constexpr float kMargin = 0.3f;  // [radii]
    return quads.empty() ? quads : quads.inflated(kMargin * radius);
}

/// Returns the support of a segment of a field, which ends at a distance of `reach` radii.
COPPICE_HOST_DEVICE inline SegmentSupport segment_support(const kernel::SegmentConstants<float>& s,
                                                          float reach) {
    const Vec3 start{s.ax, s.ay, s.az}, u{s.ux, s.uy, s.uz};
    const Vec3 a = start + s.begin * u, b = start + s.end * u;
    // An extension continues to taper with SCALIS, and keeps the node's radius otherwise: the maximum of both
    // is safe.
    const float radius_a = reach * std::max(s.radius, s.radius + s.slope * s.begin);
    const float radius_b = reach * std::max(s.radius + s.slope * s.length, s.radius + s.slope * s.end);
    SegmentSupport support{capsule_box(a, a, radius_a), a, b, std::max(radius_a, radius_b)};
    support.box.extend(capsule_box(b, b, radius_b));
    return support;
}

/// Returns the support of a competing segment: farther away its field is too weak for a contact.
COPPICE_HOST_DEVICE inline SegmentSupport competitor_capsule(const Segment& s) {
    constexpr float kReach = 1.15f;  // [radii]
    const float reach = kReach * std::max(s.radius_a, s.radius_b);
    return {capsule_box(s.a, s.b, reach), s.a, s.b, reach};
}

/// Returns the support of a tube: the capsule of its only segment, the ball around several segments, or the
/// capsule of its own line if there are no segments. `inside` are its segments, `supports` are indexed by
/// segment.
template <class Supports>
COPPICE_HOST_DEVICE SegmentSupport tube_support(std::span<const std::uint32_t> inside,
                                                const Supports& supports, const Segment& line) {
    constexpr float kEmptyReach = 1.5f;  // [radii]
    if (inside.size() == 1) return supports[inside[0]];
    Box3 box;
    for (const std::uint32_t s : inside) box.extend(supports[s].box);
    if (inside.empty()) box = capsule_box(line.a, line.b, kEmptyReach * line.radius_b);
    return {box, box.center(), box.center(), 0.5f * box.diagonal()};
}

/// The range of a tube's subtree in depth-first order.
struct TubeRelation {
    std::uint32_t tube = 0;  ///< its number
    std::uint32_t end = 0;   ///< index after the last tube of its subtree: see subtree_ends
    NodeId parent;           ///< invalid for the first tube of a tree

    /// Returns whether the other tube is in the subtree of this one.
    COPPICE_HOST_DEVICE bool holds(const TubeRelation& other) const {
        return tube <= other.tube && other.tube < end;
    }
};

/// Returns whether one tube is an ancestor or sibling of the other, or the same.
COPPICE_HOST_DEVICE inline bool are_related(const TubeRelation& a, const TubeRelation& b) {
    return a.holds(b) || b.holds(a) || (a.parent && a.parent == b.parent);
}

}  // namespace coppice
