// Included once for scalars, and again by field_simd.cpp for every instruction set: see kernel_math.h.
#if !defined(COPPICE_FIELD_SCALIS_KERNEL_H) || defined(COPPICE_KERNEL_PER_TARGET)
#define COPPICE_FIELD_SCALIS_KERNEL_H

#ifndef COPPICE_KERNEL_PER_TARGET
#include "coppice/field/kernel/segment_kernel.h"
#endif

namespace coppice::COPPICE_KERNEL_NAMESPACE {

/// The scale-invariant integral of the compact kernel (1 - r^2/4)^3, r < 2, in units of the radius tau at
/// each point x of the line: F = 1/N int K(|P - G(x)| / tau(x)) dx / tau(x) [Zanni2013], with N such that a
/// cylinder is exact. Gauss-Legendre quadrature with five points on the portion of the segment with balls of
/// two radii that contain P: exact without taper, where the integrand has degree 6. (The closed form cancels
/// for small slopes and is unusable in float.)
template <class T>
class ScalisKernel {
  public:
    static constexpr double kSupport = 2;     ///< [radii]
    static constexpr double kMaxSlope = 0.4;  ///< the clipping needs kSupport * slope < 1

    /// Adds the contribution of one segment at p: value and gradient.
    COPPICE_HOST_DEVICE void add(const SegmentConstants<T>& s, Point<T> p, Sample<T>& sum) const {
        const T wx = p.x - s.ax, wy = p.y - s.ay, wz = p.z - s.az;
        const T t = wx * s.ux + wy * s.uy + wz * s.uz;
        const T qx = wx - t * s.ux, qy = wy - t * s.uy, qz = wz - t * s.uz;
        const T h2 = qx * qx + qy * qy + qz * qz;
        const T tau = s.radius + s.slope * t;  // of the infinite cone at the closest point; may be negative
        // x is inside if (x - t)^2 + h^2 < sigma^2 (tau + slope (x - t))^2.
        const T a = T(1) - T(kSupport * kSupport) * s.slope * s.slope;
        const T inv_a = T(1) / a;
        const T middle = t + T(kSupport * kSupport) * s.slope * tau * inv_a;
        const T reach = square_root(larger(T(kSupport * kSupport) * (tau * tau) - h2 * a, T(0))) * inv_a;
        const T low = larger(s.begin, middle - reach), high = smaller(s.end, middle + reach);
        const T half = T(0.5) * larger(high - low, T(0));
        // Clamped to the line even if no portion is inside, so that the radius there is above 0.
        const T center = larger(smaller(T(0.5) * (high + low), s.end), s.begin);

        Sums nodes{T(0), T(0), T(0)};
        add_node(s, t, h2, center, T(0.56888888888888889), nodes);
        add_node(s, t, h2, center - half * T(0.53846931010568309), T(0.47862867049936647), nodes);
        add_node(s, t, h2, center + half * T(0.53846931010568309), T(0.47862867049936647), nodes);
        add_node(s, t, h2, center - half * T(0.90617984593866399), T(0.23692688505618909), nodes);
        add_node(s, t, h2, center + half * T(0.90617984593866399), T(0.23692688505618909), nodes);

        const T scale = T(1 / line_integral()) * s.weight * half;
        const T gradient = T(6 / (kSupport * kSupport)) * scale;
        sum.value = sum.value + scale * nodes.value;
        sum.gx = sum.gx + gradient * (nodes.axial * s.ux - nodes.radial * qx);
        sum.gy = sum.gy + gradient * (nodes.axial * s.uy - nodes.radial * qy);
        sum.gz = sum.gz + gradient * (nodes.axial * s.uz - nodes.radial * qz);
    }

  private:
    struct Sums {
        T value, axial, radial;
    };

    /// Adds the integrand at x; t is the closest point.
    COPPICE_HOST_DEVICE static void add_node(const SegmentConstants<T>& s, T t, T h2, T x, T weight,
                                             Sums& sums) {
        const T y = x - t;
        const T inv = T(1) / (s.radius + s.slope * x);
        const T inv2 = inv * inv;
        const T k = larger(T(1) - T(1 / (kSupport * kSupport)) * (y * y + h2) * inv2, T(0));
        const T wk2 = weight * k * k * inv;
        sums.value = sums.value + wk2 * k;
        sums.radial = sums.radial + wk2 * inv2;
        sums.axial = sums.axial + wk2 * inv2 * y;
    }

    /// Returns the integral of (1 - r^2/4)^3 along an infinite line at distance 1: 27 sqrt(3) / 70 = 32/35
    /// 3^(7/2) / 2^6.
    COPPICE_HOST_DEVICE static constexpr double line_integral() { return 27 * 1.73205080756887729353 / 70; }
};

}  // namespace coppice::COPPICE_KERNEL_NAMESPACE

#endif
