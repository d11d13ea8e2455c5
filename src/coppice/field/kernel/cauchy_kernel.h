// Included once for scalars, and again by field_simd.cpp for every instruction set: see kernel_math.h.
#if !defined(COPPICE_FIELD_CAUCHY_KERNEL_H) || defined(COPPICE_KERNEL_PER_TARGET)
#define COPPICE_FIELD_CAUCHY_KERNEL_H

#ifndef COPPICE_KERNEL_PER_TARGET
#include "coppice/field/kernel/segment_kernel.h"
#endif

namespace coppice::COPPICE_KERNEL_NAMESPACE {

/// The Cauchy kernel 1 / (1 + k^2 r^2)^2 integrated along a line and scaled so that an infinite line has the
/// value 1 at distance 1 [Zhu2015, eq. 3]. k > 0 is the width s in units of 1 / local radius; the support is
/// infinite.
template <class T>
class CauchyKernel {
  public:
    /// `weight` = line_weight(width), to be computed once for many kernels.
    COPPICE_HOST_DEVICE CauchyKernel(double width, double weight)
        : k_(width),
          k2_(width * width),
          weight_(weight),
          half_weight_(0.5 * weight),
          weight_d_h2_(-0.5 * width * width * weight) {}

    /// Returns the factor with which an infinite line has the value 1 at distance 1.
    COPPICE_HOST_DEVICE static double line_weight(double width) {
        const double q = 1 + width * width;
        return 2 / 3.14159265358979323846 * width * q * std::sqrt(q);
    }

    /// Returns the integral over a section of a line, and its derivatives.
    COPPICE_HOST_DEVICE NormalForm<T> operator()(T h2, T x0, T x1) const {
        const T p2 = T(1) + k2_ * h2;
        const T kp = k_ * square_root(p2);
        const T r = T(1) / p2;
        const T i0 = T(1) / (p2 + k2_ * x0 * x0), i1 = T(1) / (p2 + k2_ * x1 * x1);
        // The difference of two arctangents as one angle avoids cancellation between close ends.
        const T angle = upper_angle(kp * (x1 - x0), p2 + k2_ * x0 * x1);
        const T sum = (x1 * i1 - x0 * i0) + angle / kp;
        const T second = x1 * i1 * i1 - x0 * i0 * i0;
        return {half_weight_ * r * sum, weight_d_h2_ * r * (second + T(1.5) * r * sum), -weight_ * i0 * i0,
                weight_ * i1 * i1};
    }

  private:
    T k_, k2_, weight_, half_weight_, weight_d_h2_;
};

}  // namespace coppice::COPPICE_KERNEL_NAMESPACE

#endif
