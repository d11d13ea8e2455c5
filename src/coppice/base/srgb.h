#pragma once

#include <cmath>

namespace coppice {

/// Decodes a channel of a colour from sRGB to linear light, both from 0 to 1 (IEC 61966-2-1).
inline float decode_srgb(float x) {
    return x <= 0.04045f ? x / 12.92f : std::pow((x + 0.055f) / 1.055f, 2.4f);
}

}  // namespace coppice
