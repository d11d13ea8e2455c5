#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>

#include "coppice/base/vec.h"

namespace coppice {

/// Decodes a channel of a colour from sRGB to linear light, both from 0 to 1 (IEC 61966-2-1).
inline float decode_srgb(float x) {
    return x <= 0.04045f ? x / 12.92f : std::pow((x + 0.055f) / 1.055f, 2.4f);
}

/// Returns a colour from 0 to 1 of its bytes.
constexpr Vec3d srgb(int red, int green, int blue) { return Vec3d(red, green, blue) / 255.0; }

/// Returns the bytes of a colour; channels outside 0 to 1 are clamped.
template <class T>
std::array<std::uint8_t, 3> to_bytes(BasicVec3<T> color) {
    const auto byte = [](T x) {
        return static_cast<std::uint8_t>(std::lround(255 * std::clamp(x, T{0}, T{1})));
    };
    return {byte(color.x), byte(color.y), byte(color.z)};
}

}  // namespace coppice
