#pragma once

#include <algorithm>
#include <array>
#include <cmath>

#include "coppice/base/kernel/host_device.h"

namespace coppice {

/// Coefficients of a polynomial in z² for arctan(z) / z, highest power first, through the Chebyshev points of
/// [0, 1]: relative error 2e-8.
inline constexpr std::array<double, 9> kArctan{0.0027662835,  -0.0157312491, 0.0421376236,
                                               -0.0745685483, 0.106183706,   -0.141977978,
                                               0.19991872,    -0.333330367,  0.999999982};

/// Returns the angle of (x, y) in [-pi, pi] like std::atan2, and 0 for a zero vector; up to 4e-7 off and
/// several times faster: for geometry that affects no decisions.
COPPICE_HOST_DEVICE inline float fast_atan2(float y, float x) {
    constexpr auto kFactors = kArctan;  // copied, because a GPU cannot access the memory of the host
    constexpr float kPi = 3.14159265358979f;
    const float across = std::abs(y), along = std::abs(x);
    const float z = std::min(across, along) / std::max(std::max(across, along), 1e-37f);
    const float s = z * z;
    float p = 0;
    for (const double c : kFactors) p = p * s + static_cast<float>(c);
    p *= z;
    if (across > along) p = kPi / 2 - p;
    if (x < 0) p = kPi - p;
    return std::copysign(p, y);
}

}  // namespace coppice
