// Included once for scalars, and again by field_simd.cpp for every instruction set: see kernel_math.h.
#if !defined(COPPICE_FIELD_BALL_KERNEL_H) || defined(COPPICE_KERNEL_PER_TARGET)
#define COPPICE_FIELD_BALL_KERNEL_H

#ifndef COPPICE_KERNEL_PER_TARGET
#include "coppice/field/kernel/segment_kernel.h"
#endif

namespace coppice::COPPICE_KERNEL_NAMESPACE {

/// Metaballs (1 - r^2/R^2)^2 along a segment instead of the integral over it, as in [Ji2010], with which
/// [Zhu2015] compares: R = `support` local radii. Balls are evenly spaced from end to end of the line, those
/// at the ends have half weight, and each is weighted by its share of the line in local radii: the
/// trapezoidal rule for the quartic kernel's integral, so that a long chain has the value 1 at its radius on
/// average, and many balls converge to the line.
template <class T>
class BallKernel {
  public:
    /// `weight` = line_weight(support) of the quartic kernel, to be computed once for many kernels.
    COPPICE_HOST_DEVICE BallKernel(double support, double weight)
        : support_(support), support2_(support * support), weight_(weight) {}

    /// Adds the balls of one segment at p. Balls out of reach of all points of a vector are skipped: they add
    /// 0.
    COPPICE_HOST_DEVICE void add(const SegmentConstants<T>& s, Point<T> p, Sample<T>& sum) const {
        if (s.balls == 0) return;
        const T wx = p.x - s.ax, wy = p.y - s.ay, wz = p.z - s.az;
        const T t = wx * s.ux + wy * s.uy + wz * s.uz;
        const T spacing = (s.end - s.begin) * T(1.0f / static_cast<float>(s.balls));
        const T reach = support_ * larger(s.radius, s.radius + s.slope * s.length);
        const T per_spacing = T(1) / spacing;
        const auto last_ball = static_cast<float>(s.balls);
        const auto from = static_cast<float>(least((t - reach - s.begin) * per_spacing));
        const auto to = static_cast<float>(largest((t + reach - s.begin) * per_spacing));
        // All balls are used for NaN.
        const int first = from > 0 ? static_cast<int>(std::min(from, last_ball)) : 0;
        const int last = to + 1 < last_ball ? static_cast<int>(std::max(to + 1, -1.0f)) : s.balls;
        for (int k = first; k <= last; ++k) {
            const T x = s.begin + T(k) * spacing;
            const T inv = T(1) / (s.radius + s.slope * larger(smaller(x, s.length), T(0)));
            const T inv2 = inv * inv;
            const T dx = wx - x * s.ux, dy = wy - x * s.uy, dz = wz - x * s.uz;
            const T inside = larger(support2_ - (dx * dx + dy * dy + dz * dz) * inv2, T(0));
            const T part = k == 0 || k == s.balls ? T(0.5) : T(1);
            const T share = part * s.weight * weight_ * spacing * inv * inside;
            const T fall = T(-4) * share * inv2;
            sum.value = sum.value + share * inside;
            sum.gx = sum.gx + fall * dx;
            sum.gy = sum.gy + fall * dy;
            sum.gz = sum.gz + fall * dz;
        }
    }

  private:
    T support_, support2_, weight_;
};

}  // namespace coppice::COPPICE_KERNEL_NAMESPACE

#endif
