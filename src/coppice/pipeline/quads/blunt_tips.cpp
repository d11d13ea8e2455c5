#include <algorithm>
#include <cmath>
#include <vector>

#include "coppice/pipeline/quads/blunt_tips_internal.h"

namespace coppice::pipeline_internal {
namespace {

// [m] Returns the end radius of a frustum that begins with the radius of a tube, ends one radius beyond its
// tip, and has the volume of the tube and the specified half ball.
float end_radius(const Segment& tube) {
    const float a = tube.radius_a, b = tube.radius_b, l = distance(tube.a, tube.b);
    const float mean_square = (l * (a * a + a * b + b * b) + 2 * b * b * b) / (l + b);  // times 3
    return 0.5f * (std::sqrt(std::max(0.0f, 4 * mean_square - 3 * a * a)) - a);
}

Vec3 point_at_end(Vec3 p, const Segment& s) {
    // Vertices closer to the axis, relative to their distance from the tip, are the middle of the end.
    constexpr float kMiddle = 0.1f;
    const Vec3 axis = normalized(s.b - s.a), end = s.b + axis * s.radius_b;
    const Vec3 from_tip = p - s.b, across = from_tip - axis * dot(from_tip, axis);
    const float radius = length(from_tip), off = length(across);
    return off > kMiddle * radius ? end + across * (end_radius(s) / s.radius_b * radius / off) : end;
}

}  // namespace

void shape_blunt_tips(const ControlMesh& control, const Skeleton& tubes,
                      const std::function<bool(NodeId)>& has_blunt_tip,
                      const std::function<Vec3&(std::uint32_t)>& position) {
    std::vector<bool> is_done(control.cage.positions.size());
    for (std::size_t q = 0; q < control.part.size(); ++q) {
        const NodeId tip(control.region[q]);
        if (control.part[q] != TubeFace::end || tubes.is_root(tip) || !has_blunt_tip(tip)) continue;
        for (const std::uint32_t v : control.cage.quads[q]) {
            if (is_done[v]) continue;
            is_done[v] = true;
            Vec3& p = position(v);
            p = point_at_end(p, tubes.segment(tip));
        }
    }
}

}  // namespace coppice::pipeline_internal
