#include "coppice/measure/forks_internal.h"

namespace coppice::measure_internal {

Forks::Forks(const Skeleton& skeleton, Vec3d origin, double reach, const Context& ctx)
    : balls_(balls(skeleton, origin, reach)), boxes_(compute_boxes(balls_), ctx) {}

bool Forks::contain(Vec3d p) const {
    Box3 box;
    extend_outward(box, p);
    bool found = false;
    boxes_.visit_overlapping(box, [&](std::uint32_t i) {
        found = distance(balls_[i].center, p) <= balls_[i].radius;
        return !found;
    });
    return found;
}

std::vector<Forks::Ball> Forks::balls(const Skeleton& s, Vec3d origin, double reach) {
    std::vector<Ball> out;
    for (const NodeId n : nodes(s)) {
        const std::size_t neighbours = s.children(n).size() + (s.is_root(n) ? 0 : 1);
        if (neighbours < 3) continue;
        out.push_back({Vec3d(s.position(n)) + (s.origin() - origin), reach * double{s.radius(n)}});
    }
    return out;
}

std::vector<Box3> Forks::compute_boxes(const std::vector<Ball>& balls) {
    std::vector<Box3> out(balls.size());
    for (std::size_t i = 0; i < balls.size(); ++i) extend_outward(out[i], balls[i].center, balls[i].radius);
    return out;
}

}  // namespace coppice::measure_internal
