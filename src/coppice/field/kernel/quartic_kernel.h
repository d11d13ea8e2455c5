// Included once for scalars, and again by field_simd.cpp for every instruction set: see kernel_math.h.
#if !defined(COPPICE_FIELD_QUARTIC_KERNEL_H) || defined(COPPICE_KERNEL_PER_TARGET)
#define COPPICE_FIELD_QUARTIC_KERNEL_H

#ifndef COPPICE_KERNEL_PER_TARGET
#include "coppice/field/kernel/segment_kernel.h"
#endif

namespace coppice::COPPICE_KERNEL_NAMESPACE {

/// The quartic kernel (1 - r^2/R^2)^2 for r < R, else 0, integrated along a line and scaled so that an
/// infinite line has the value 1 at distance 1 [Zhu2015, eq. 4]. R > 1 is the support in units of the local
/// radius.
template <class T>
class QuarticKernel {
  public:
    /// `weight` = line_weight(support), to be computed once for many kernels.
    COPPICE_HOST_DEVICE QuarticKernel(double support, double weight)
        : support2_(support * support), weight_(weight), weight_d_h2_(-2 * weight) {}

    /// Returns the factor with which an infinite line has the value 1 at distance 1.
    COPPICE_HOST_DEVICE static double line_weight(double support) {
        const double b2 = support * support - 1;
        return 15 / (16 * b2 * b2 * std::sqrt(b2));
    }

    /// Returns the integral over a section of a line, and its derivatives.
    COPPICE_HOST_DEVICE NormalForm<T> operator()(T h2, T x0, T x1) const {
        const T b2 = larger(support2_ - h2, T(0));  // squared half length of the line inside the support
        const T b = square_root(b2);
        const T c0 = larger(smaller(x0, b), -b), c1 = larger(smaller(x1, b), -b);
        const T s0 = c0 * c0, s1 = c1 * c1;
        const T b4 = b2 * b2, b23 = T(2.0 / 3) * b2;
        const T f0 = c0 * (b4 - s0 * (b23 - T(0.2) * s0));
        const T f1 = c1 * (b4 - s1 * (b23 - T(0.2) * s1));
        const T g0 = c0 * (b2 - T(1.0 / 3) * s0), g1 = c1 * (b2 - T(1.0 / 3) * s1);
        const T k0 = b2 - s0, k1 = b2 - s1;  // 0 at a clipped end
        return {weight_ * (f1 - f0), weight_d_h2_ * (g1 - g0), -weight_ * k0 * k0, weight_ * k1 * k1};
    }

  private:
    T support2_, weight_, weight_d_h2_;
};

}  // namespace coppice::COPPICE_KERNEL_NAMESPACE

#endif
