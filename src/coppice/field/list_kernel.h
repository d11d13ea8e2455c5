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

/// Of more rivals the nearest are kept: surfaces in contact on more sides have nowhere to go.
inline constexpr std::size_t kMostRivals = 48;
/// Segments that a search for rivals looks at.
inline constexpr std::size_t kMostNear = 1024;

/// The box of a region, of that about its quads and their anchors and the radius of the segment that names
/// it.
COPPICE_HOST_DEVICE inline Box3 region_box(const Box3& quads, float radius) {
    constexpr float kMargin = 0.3f;  // [radii]
    return quads.empty() ? quads : quads.inflated(kMargin * radius);
}

/// Where a segment of a field has influence, which ends `reach` radii away.
COPPICE_HOST_DEVICE inline SegmentSupport segment_support(const kernel::SegmentConstants<float>& s,
                                                          float reach) {
    const Vec3 start{s.ax, s.ay, s.az}, u{s.ux, s.uy, s.uz};
    const Vec3 a = start + s.begin * u, b = start + s.end * u;
    // An extension of SCALIS goes on tapering, the others keep the node's radius: the greater of both is
    // safe.
    const float radius_a = reach * std::max(s.radius, s.radius + s.slope * s.begin);
    const float radius_b = reach * std::max(s.radius + s.slope * s.length, s.radius + s.slope * s.end);
    SegmentSupport support{capsule_box(a, a, radius_a), a, b, std::max(radius_a, radius_b)};
    support.box.extend(capsule_box(b, b, radius_b));
    return support;
}

/// Where a segment is a rival: farther away its field is too weak to push back.
COPPICE_HOST_DEVICE inline SegmentSupport rival_capsule(const Segment& s) {
    constexpr float kReach = 1.15f;  // [radii]
    const float reach = kReach * std::max(s.radius_a, s.radius_b);
    return {capsule_box(s.a, s.b, reach), s.a, s.b, reach};
}

/// Where a tube has influence: the capsule of its one segment, the ball about several, its own line for none.
/// `inside` are its segments, `supports` those of all.
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

/// A tube among others in depth-first order.
struct TubeKin {
    std::uint32_t tube = 0;  ///< its number
    std::uint32_t end = 0;   ///< those of its subtree are below it: see subtree_ends
    NodeId parent;           ///< none for the first of a tree

    /// Whether the other one is of this one's subtree.
    COPPICE_HOST_DEVICE bool holds(const TubeKin& other) const {
        return tube <= other.tube && other.tube < end;
    }
};

/// Whether one tube is an ancestor of the other, or its sibling, or the same.
COPPICE_HOST_DEVICE inline bool are_related(const TubeKin& a, const TubeKin& b) {
    return a.holds(b) || b.holds(a) || (a.parent && a.parent == b.parent);
}

}  // namespace coppice
