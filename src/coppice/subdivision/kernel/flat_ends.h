#pragma once

#include <algorithm>
#include <cstdint>
#include <span>
#include <vector>

#include "coppice/base/id.h"
#include "coppice/base/kernel/partition_point.h"
#include "coppice/mesh/control_mesh.h"
#include "coppice/subdivision/kernel/patch_index.h"

namespace coppice {

/// Returns the orthogonal projection on a plane.
COPPICE_HOST_DEVICE inline Vec3 dropped(Vec3 p, const ClipPlane& plane) {
    const float height = dot(plane.normal, p) - plane.offset;
    return p + plane.normal * (-height / length_squared(plane.normal));
}

/// The cage quads and refined vertices of flat ends. `clips` are ordered by first quad and disjoint.
class FlatEnds {
  public:
    /// Position of a vertex on a flat end.
    struct Place {
        std::uint32_t end = kNoIndex;  ///< index of the clip
        bool on_rim = false;           ///< also a corner of a face outside this end, or on a boundary
    };

    /// The clips must outlive this object.
    COPPICE_HOST_DEVICE explicit FlatEnds(std::span<const ClipPlane> clips) : clips_(clips) {}

    /// no flat ends
    COPPICE_HOST_DEVICE bool empty() const { return clips_.empty(); }

    /// Returns the end that contains a cage quad.
    COPPICE_HOST_DEVICE std::uint32_t of_face(std::uint32_t cage_face) const {
        const std::uint32_t after =
            kernel::partition_point(clips_, [&](const ClipPlane& c) { return c.first_quad <= cage_face; });
        if (after == 0) return kNoIndex;
        const std::uint32_t end = after - 1;
        return cage_face - clips_[end].first_quad < clips_[end].quad_count ? end : kNoIndex;
    }

    /// Of two ends that share the vertex, returns the first.
    COPPICE_HOST_DEVICE Place of_vertex(const PatchStars& stars, int levels, std::uint32_t vertex) const {
        if (empty()) return {};
        Place place;
        bool elsewhere = stars.on_boundary(vertex);
        stars.for_each_corner(vertex, [&](QuadCorner c) {
            const std::uint32_t end = of_face(c.quad >> (2 * levels));
            elsewhere = elsewhere || end == kNoIndex || (place.end != kNoIndex && end != place.end);
            place.end = std::min(place.end, end);
        });
        return {place.end, place.end != kNoIndex && elsewhere};
    }

  private:
    std::span<const ClipPlane> clips_;
};

/// The refined vertices of all flat ends, each once, end by end.
struct FlatVertices {
    std::vector<std::uint32_t> first;   ///< per end, and one more
    std::vector<std::uint32_t> vertex;  ///< by end
    std::vector<std::uint8_t> on_rim;   ///< 1 for vertices where plane and surface meet
    std::vector<bool> is_flat;          ///< per refined vertex; empty without flat ends

    /// `clips` as for FlatEnds.
    FlatVertices(const PatchStars& stars, int levels, std::span<const ClipPlane> clips);
};

}  // namespace coppice
