#pragma once

#include <algorithm>
#include <bit>
#include <cmath>
#include <cstdint>
#include <span>

#include "coppice/base/kernel/kernel_math.h"
#include "coppice/base/vec.h"
#include "coppice/mesh/mesh.h"

namespace coppice {

/// Squared sine and cosine below which a face is bad.
struct FaceLimits {
    /// Squared. @{
    float sine, cosine;
    /// @}

    /// Limits for faces with a scaled Jacobian below `quality`, or with an inward direction.
    explicit constexpr FaceLimits(float quality) : sine(quality * quality), cosine(kInward * kInward) {}

  private:
    static constexpr float kInward = 0.05f;  // cosine below which a face points inward
};

/// Returns 1 for a bad face. `outward` is the direction from the anchors to the corners. Compares squares, so
/// that there is neither root nor division; the corners have to be scaled to about 1, since lengths enter
/// with their eighth power. The areas of opposite corners add up to that of the face.
COPPICE_HOST_DEVICE COPPICE_ALWAYS_INLINE std::int32_t bad_face(Vec3 a, Vec3 b, Vec3 c, Vec3 d, Vec3 outward,
                                                                FaceLimits limits) {
    const Vec3 ab = b - a;
    const Vec3 bc = c - b;
    const Vec3 cd = d - c;
    const Vec3 da = a - d;
    const Vec3 normal = cross(c - a, d - b);
    const float size = length_squared(normal);
    const float at_a = dot(cross(da, ab), normal);
    const float at_b = dot(cross(ab, bc), normal);
    const float at_c = size - at_a;
    const float at_d = size - at_b;
    const float limit = limits.sine * size;
    const float ab2 = length_squared(ab);
    const float bc2 = length_squared(bc);
    const float cd2 = length_squared(cd);
    const float da2 = length_squared(da);
    const float out = dot(normal, outward);
    const bool convex = (at_a > 0) & (at_b > 0) & (at_c > 0) & (at_d > 0);
    const bool even = (at_a * at_a >= limit * (da2 * ab2)) & (at_b * at_b >= limit * (ab2 * bc2)) &
                      (at_c * at_c >= limit * (bc2 * cd2)) & (at_d * at_d >= limit * (cd2 * da2));
    const bool outer = (out >= 0) & (out * out >= limits.cosine * (size * length_squared(outward)));
    return (convex & even & outer) ? 0 : 1;
}

/// Returns the power of two that scales a length to between 1 and 2, within the range of floats.
COPPICE_HOST_DEVICE inline float compute_scale(float extent) {
    constexpr std::int32_t kExponent = 0x7f800000;
    const std::int32_t exponent = std::bit_cast<std::int32_t>(extent) & kExponent;
    return std::bit_cast<float>(std::clamp(0x7f000000 - exponent, 0x00800000, 0x7f000000));
}

/// Returns the maximum absolute coordinate.
COPPICE_HOST_DEVICE inline float extent(Vec3 a) {
    return kernel::larger(std::abs(a.x), kernel::larger(std::abs(a.y), std::abs(a.z)));
}

/// Returns whether a face of a surface is bad; one position and one anchor per vertex.
COPPICE_HOST_DEVICE inline bool is_bad_face(const Quad& face, std::span<const Vec3> positions,
                                            std::span<const Vec3> anchors, FaceLimits limits) {
    const Vec3 a = positions[face[0]];
    const auto reach = [&](int k) { return extent(positions[face[k]] - a); };
    const float scale = compute_scale(kernel::larger(reach(1), kernel::larger(reach(2), reach(3))));
    const auto away = [&](int k) { return scale * (positions[face[k]] - anchors[face[k]]); };
    const Vec3 outward = (away(0) + away(1)) + (away(2) + away(3));
    const auto point = [&](int k) { return scale * positions[face[k]]; };
    return bad_face(point(0), point(1), point(2), point(3), outward, limits) != 0;
}

}  // namespace coppice
