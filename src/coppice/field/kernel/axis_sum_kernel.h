// Included once for plain numbers, and again by field_simd.cpp for every instruction set: see kernel_math.h.
#if !defined(COPPICE_FIELD_AXIS_SUM_KERNEL_H) || defined(COPPICE_KERNEL_PER_TARGET)
#define COPPICE_FIELD_AXIS_SUM_KERNEL_H

#ifndef COPPICE_KERNEL_PER_TARGET
#include "coppice/field/kernel/ball_kernel.h"
#include "coppice/field/kernel/scalis_kernel.h"
#include "coppice/field/kernel/segment_kernel.h"
#endif

namespace coppice::COPPICE_KERNEL_NAMESPACE {

/// Adds what one segment contributes at p, by whatever kernel.
/// @{
template <class K, class T>
COPPICE_HOST_DEVICE inline void add_contribution(const K& formula, const SegmentConstants<T>& s, Point<T> p,
                                                 Sample<T>& sum) {
    add_segment(formula, s, p, sum);
}
template <class T>
COPPICE_HOST_DEVICE inline void add_contribution(const ScalisKernel<T>& formula, const SegmentConstants<T>& s,
                                                 Point<T> p, Sample<T>& sum) {
    formula.add(s, p, sum);
}
template <class T>
COPPICE_HOST_DEVICE inline void add_contribution(const BallKernel<T>& formula, const SegmentConstants<T>& s,
                                                 Point<T> p, Sample<T>& sum) {
    formula.add(s, p, sum);
}
/// @}

/// total += F^n, and its gradient / n: F^(n-1) times that of F, the sum of one axis; n is 2, 4 or 8.
template <int n, class T>
COPPICE_HOST_DEVICE inline void add_power(Sample<T> axis, Sample<T>& total) {
    // Powers stay finite even for the sum of all 2^32 segments that a skeleton can have, and are normal
    // numbers or 0: others are slow. What a power hides is beyond the accuracy of the field.
    constexpr float kLeast = n == 8 ? 0x1p-15f : n == 4 ? 0x1p-30f : 0x1p-60f;
    const T f = smaller(value_from(axis.value, T(kLeast)), T(2048.0f));
    T power = f, square = f;  // F^(n-1) is F, F F^2 or F F^2 F^4
    for (int k = 2; k < n; k *= 2) {
        square = square * square;
        power = power * square;
    }
    total.value = total.value + power * f;
    total.gx = total.gx + power * axis.gx;
    total.gy = total.gy + power * axis.gy;
    total.gz = total.gz + power * axis.gz;
}

/// The n-th root of what add_power summed up.
template <int n, class T>
COPPICE_HOST_DEVICE inline Sample<T> take_root(Sample<T> total) {
    T root = total.value;
    for (int k = 1; k < n; k *= 2) root = square_root(root);
    // F^(1-n); of nothing, 0. The least normal number keeps the quotient finite.
    const T scale = root * (T(1.0f) / larger(total.value, T(1.17549435e-38f)));
    return {root, scale * total.gx, scale * total.gy, scale * total.gz};
}

}  // namespace coppice::COPPICE_KERNEL_NAMESPACE

#endif
