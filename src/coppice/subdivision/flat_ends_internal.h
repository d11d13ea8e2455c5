#pragma once

#include <algorithm>
#include <cstdint>
#include <span>
#include <vector>

#include "coppice/mesh/control_mesh.h"
#include "coppice/subdivision/catmull_clark.h"
#include "coppice/subdivision/patch_index_internal.h"

namespace coppice {

// The foot of the perpendicular on a plane.
inline Vec3 dropped(Vec3 p, const ClipPlane& plane) {
    const float height = dot(plane.normal, p) - plane.offset;
    return p + plane.normal * (-height / length_squared(plane.normal));
}

// Which cage quads and refined vertices belong to flat ends. `clips` are ordered by first quad and disjoint.
class FlatEnds {
  public:
    static constexpr std::uint32_t kNone = 0xffffffffu;

    struct Place {
        std::uint32_t end = kNone;
        bool on_rim = false;  // also a corner of a face that is not of this end, or on a boundary
    };

    explicit FlatEnds(std::span<const ClipPlane> clips) : clips_(clips) {}

    bool empty() const { return clips_.empty(); }

    std::uint32_t of_face(std::uint32_t cage_face) const {
        const auto after =
            std::upper_bound(clips_.begin(), clips_.end(), cage_face,
                             [](std::uint32_t f, const ClipPlane& c) { return f < c.first_quad; });
        if (after == clips_.begin()) return kNone;
        const auto end = static_cast<std::uint32_t>(after - clips_.begin()) - 1;
        return cage_face - clips_[end].first_quad < clips_[end].quad_count ? end : kNone;
    }

    // Of two ends that share the vertex, the first counts.
    Place of_vertex(const PatchStars& stars, int levels, std::uint32_t vertex) const {
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

// The refined vertices of all flat ends, each once, end by end.
struct FlatVertices {
    std::vector<std::uint32_t> first;  // per end, and one more
    std::vector<std::uint32_t> vertex;
    std::vector<std::uint8_t> on_rim;
    std::vector<bool> is_flat;  // per refined vertex; empty without flat ends

    FlatVertices(const PatchRefinement& patches, std::span<const ClipPlane> clips);
};

}  // namespace coppice
