#include <algorithm>
#include <cmath>

#include "coppice/base/kernel/fast_atan2.h"
#include "coppice/cage/crotch_internal.h"

namespace coppice::cage_internal {
namespace {

// The first cylinder is the thicker one.
Crotch crotch_with_thinner(Vec3 a, float radius_a, Vec3 b, float radius_b) {
    const float s = length(cross(a, b)), c = dot(a, b), along = radius_b / radius_a + c;
    if (along <= 0) {
        // The thinner one leaves backwards, through the ball at the beginning of the thicker one.
        const float sine_b = radius_b / radius_a;
        const float angle_b = fast_atan2(sine_b, std::sqrt(std::max(0.0f, 1 - sine_b * sine_b)));
        return {radius_a, fast_atan2(s, c) - angle_b, angle_b};
    }
    const float sine_a = s / std::sqrt(s * s + along * along);
    const float angle_a = fast_atan2(s, along);
    return {radius_a / std::max(sine_a, 1e-3f), angle_a, fast_atan2(s, c) - angle_a};
}

}  // namespace

Crotch crotch(Vec3 a, float radius_a, Vec3 b, float radius_b) {
    if (radius_a >= radius_b) return crotch_with_thinner(a, radius_a, b, radius_b);
    const Crotch k = crotch_with_thinner(b, radius_b, a, radius_a);
    return {k.distance, k.angle_b, k.angle_a};
}

}  // namespace coppice::cage_internal
