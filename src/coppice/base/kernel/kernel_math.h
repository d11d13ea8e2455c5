#pragma once

#include <algorithm>
#include <bit>
#include <cmath>
#include <cstdint>
#include <limits>

#include "coppice/base/kernel/fast_atan2.h"
#include "coppice/base/kernel/host_device.h"

/// The namespace of the formulas in *_kernel.h. Plain numbers use coppice::kernel; sources of Highway define
/// COPPICE_KERNEL_PER_TARGET and include the same headers again for every instruction set, each into a
/// namespace of its own, because a function can only be inlined into code of its own instruction set.
#ifndef COPPICE_KERNEL_NAMESPACE
#define COPPICE_KERNEL_NAMESPACE kernel
#endif

/// What the formulas need besides + - *, /, for float and double. A vector type brings its own set, found by
/// its namespace.
namespace coppice::kernel {

/// The lesser of two, without branches.
template <class T>
COPPICE_HOST_DEVICE inline T smaller(T a, T b) {
    return b < a ? b : a;
}

/// The greater of two, without branches.
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

/// `yes` where the mask is true, else `no`.
template <class T>
COPPICE_HOST_DEVICE inline T choose(bool mask, T yes, T no) {
    return mask ? yes : no;
}

/// `value` where the mask is true, else 0.
template <class T>
COPPICE_HOST_DEVICE inline T value_where(bool mask, T value) {
    return mask ? value : T(0);
}

/// The number whose bits are `from` less `factor` times the bits of x: a first guess at a power of x.
COPPICE_HOST_DEVICE inline float guess_by_bits(std::int32_t from, float factor, float x) {
    const auto bits = static_cast<float>(std::bit_cast<std::int32_t>(x));
    return std::bit_cast<float>(from - static_cast<std::int32_t>(factor * bits));
}

/// `value` where 0 < x < high, else 0.
template <class T>
COPPICE_HOST_DEVICE inline T value_within(T x, T high, T value) {
    return x > T(0) && x < high ? value : T(0);
}

/// `x` from `low` on, else 0.
template <class T>
COPPICE_HOST_DEVICE inline T value_from(T x, T low) {
    return x >= low ? x : T(0);
}

/// The least of all numbers of a vector; of one number, itself.
template <class T>
COPPICE_HOST_DEVICE inline T least(T x) {
    return x;
}

/// The greatest of all numbers of a vector; of one number, itself.
template <class T>
COPPICE_HOST_DEVICE inline T greatest(T x) {
    return x;
}

/// Angle in [0, pi] of the point (x, y) with y >= 0, off by up to 4e-7.
COPPICE_HOST_DEVICE inline float upper_angle(float y, float x) { return fast_atan2(y, x); }
/// The same in double precision, exactly.
COPPICE_HOST_DEVICE inline double upper_angle(double y, double x) { return std::atan2(y, x); }

}  // namespace coppice::kernel
