#pragma once

#include <algorithm>
#include <bit>
#include <cmath>
#include <cstdint>
#include <limits>

#include "coppice/base/kernel/fast_atan2.h"
#include "coppice/base/kernel/host_device.h"

/// The namespace of the formulas in *_kernel.h. Plain numbers use coppice::kernel; Highway sources define
/// COPPICE_KERNEL_PER_TARGET and include the same headers again for every instruction set, each into its own
/// namespace, because a function can only be inlined into code of the same instruction set.
#ifndef COPPICE_KERNEL_NAMESPACE
#define COPPICE_KERNEL_NAMESPACE kernel
#endif

/// Functions of the formulas besides + - *, /, for float and double. A vector type provides its own set,
/// found by its namespace.
namespace coppice::kernel {

/// Returns the minimum of two values, without branches.
template <class T>
COPPICE_HOST_DEVICE inline T smaller(T a, T b) {
    return b < a ? b : a;
}

/// Returns the maximum of two values, without branches.
template <class T>
COPPICE_HOST_DEVICE inline T larger(T a, T b) {
    return a < b ? b : a;
}

/// As std::sqrt, also for vectors of numbers.
COPPICE_HOST_DEVICE inline float square_root(float x) { return std::sqrt(x); }
/// As std::sqrt, also for vectors of numbers.
COPPICE_HOST_DEVICE inline double square_root(double x) { return std::sqrt(x); }

/// As std::abs, also for vectors of numbers.
COPPICE_HOST_DEVICE inline float absolute(float x) { return std::abs(x); }

/// Returns `yes` where the mask is true, else `no`.
template <class T>
COPPICE_HOST_DEVICE inline T choose(bool mask, T yes, T no) {
    return mask ? yes : no;
}

/// Returns `value` where the mask is true, else 0.
template <class T>
COPPICE_HOST_DEVICE inline T value_where(bool mask, T value) {
    return mask ? value : T(0);
}

/// Returns the number with the bits `from` minus `factor` times the bits of x: a first estimate of a power of
/// x.
COPPICE_HOST_DEVICE inline float guess_by_bits(std::int32_t from, float factor, float x) {
    const auto bits = static_cast<float>(std::bit_cast<std::int32_t>(x));
    return std::bit_cast<float>(from - static_cast<std::int32_t>(factor * bits));
}

/// Returns `value` where 0 < x < high, else 0.
template <class T>
COPPICE_HOST_DEVICE inline T value_within(T x, T high, T value) {
    return x > T(0) && x < high ? value : T(0);
}

/// Returns `x` where x >= `low`, else 0.
template <class T>
COPPICE_HOST_DEVICE inline T value_from(T x, T low) {
    return x >= low ? x : T(0);
}

/// Returns the minimum of all numbers of a vector; of one number, the number.
template <class T>
COPPICE_HOST_DEVICE inline T least(T x) {
    return x;
}

/// Returns the maximum of all numbers of a vector; of one number, the number.
template <class T>
COPPICE_HOST_DEVICE inline T largest(T x) {
    return x;
}

/// Returns the angle in [0, pi] of the point (x, y) with y >= 0, up to 4e-7 off.
COPPICE_HOST_DEVICE inline float upper_angle(float y, float x) { return fast_atan2(y, x); }
/// The same in double precision, exact.
COPPICE_HOST_DEVICE inline double upper_angle(double y, double x) { return std::atan2(y, x); }

}  // namespace coppice::kernel
