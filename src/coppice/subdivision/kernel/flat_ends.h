#pragma once

#include <algorithm>
#include <cstdint>
#include <span>
#include <vector>

#include "coppice/base/kernel/partition_point.h"
#include "coppice/mesh/control_mesh.h"
#include "coppice/subdivision/kernel/patch_index.h"

namespace coppice {

/// The foot of the perpendicular on a plane.
COPPICE_HOST_DEVICE inline Vec3 dropped(Vec3 p, const ClipPlane& plane) {
    const float height = dot(plane.normal, p) - plane.offset;
    return p + plane.normal * (-height / length_squared(plane.normal));
}

/// Which cage quads and refined vertices belong to flat ends. `clips` are ordered by first quad and disjoint.
class FlatEnds {
  public:
    static constexpr std::uint32_t kNone = 0xffffffffu;  ///< no end

    /// What a vertex is of an end.
    struct Place {
        std::uint32_t end = kNone;  ///< number of the clip
        bool on_rim = false;        ///< also a corner of a face that is not of this end, or on a boundary
    };

    /// The clips must outlive it.
    COPPICE_HOST_DEVICE explicit FlatEnds(std::span<const ClipPlane> clips) : clips_(clips) {}

    /// no flat ends
    COPPICE_HOST_DEVICE bool empty() const { return clips_.empty(); }

    /// The end that a cage quad fills.
    COPPICE_HOST_DEVICE std::uint32_t of_face(std::uint32_t cage_face) const {
        const std::uint32_t after =
            kernel::partition_point(clips_, [&](const ClipPlane& c) { return c.first_quad <= cage_face; });
        if (after == 0) return kNone;
        const std::uint32_t end = after - 1;
        return cage_face - clips_[end].first_quad < clips_[end].quad_count ? end : kNone;
    }

    /// Of two ends that share the vertex, the first counts.
    COPPICE_HOST_DEVICE Place of_vertex(const PatchStars& stars, int levels, std::uint32_t vertex) const {
        if (empty()) return {};
        Place place;
        bool elsewhere = stars.on_boundary(vertex);
        stars.for_each_corner(vertex, [&](QuadCorner c) {
            const std::uint32_t end = of_face(c.quad >> (2 * levels));
            elsewhere = elsewhere || end == kNone || (place.end != kNone && end != place.end);
            place.end = std::min(place.end, end);
        });
        return {place.end, place.end != kNone && elsewhere};
    }

  private:
    std::span<const ClipPlane> clips_;
};

/// The refined vertices of all flat ends, each once, end by end.
struct FlatVertices {
    std::vector<std::uint32_t> first;   ///< per end, and one more
    std::vector<std::uint32_t> vertex;  ///< by end
    std::vector<std::uint8_t> on_rim;   ///< 1 for those where plane and surface meet
    std::vector<bool> is_flat;          ///< per refined vertex; empty without flat ends

    /// `clips` as for FlatEnds.
    FlatVertices(const PatchStars& stars, int levels, std::span<const ClipPlane> clips);
};

}  // namespace coppice
