// Included once for scalars, and again by field_simd.cpp for every instruction set: see kernel_math.h.
#if !defined(COPPICE_FIELD_AXIS_SUM_KERNEL_H) || defined(COPPICE_KERNEL_PER_TARGET)
#define COPPICE_FIELD_AXIS_SUM_KERNEL_H

#ifndef COPPICE_KERNEL_PER_TARGET
#include "coppice/field/kernel/ball_kernel.h"
#include "coppice/field/kernel/scalis_kernel.h"
#include "coppice/field/kernel/segment_kernel.h"
#endif

namespace coppice::COPPICE_KERNEL_NAMESPACE {

/// Adds the contribution of one segment at p, for any kernel.
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

/// total += F^n, and its gradient / n: F^(n-1) times the gradient of F, the sum of one axis; n is 2, 4 or 8.
template <int n, class T>
COPPICE_HOST_DEVICE inline void add_power(Sample<T> axis, Sample<T>& total) {
    // Powers are finite even for the sum of all 2^32 segments that a skeleton can have, and are normal
    // numbers or 0, because denormal numbers are slow. The truncated values are below the accuracy of the
    // field.
    constexpr float kMin = n == 8 ? 0x1p-15f : n == 4 ? 0x1p-30f : 0x1p-60f;
    const T f = smaller(value_from(axis.value, T(kMin)), T(2048.0f));
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

/// Returns the n-th root of the sum of add_power().
template <int n, class T>
COPPICE_HOST_DEVICE inline Sample<T> take_root(Sample<T> total) {
    T root = total.value;
    for (int k = 1; k < n; k *= 2) root = square_root(root);
    // F^(1-n), or 0 if F is 0. The smallest normal number keeps the quotient finite.
    const T scale = root * (T(1.0f) / larger(total.value, T(1.17549435e-38f)));
    return {root, scale * total.gx, scale * total.gy, scale * total.gz};
}

}  // namespace coppice::COPPICE_KERNEL_NAMESPACE

#endif
