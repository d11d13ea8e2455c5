// Included once for scalars, and again by field_simd.cpp for every instruction set: see kernel_math.h.
#if !defined(COPPICE_FIELD_SEGMENT_KERNEL_H) || defined(COPPICE_KERNEL_PER_TARGET)
#define COPPICE_FIELD_SEGMENT_KERNEL_H

#include "coppice/base/kernel/kernel_math.h"

namespace coppice::COPPICE_KERNEL_NAMESPACE {

/// A segment in the form used by the kernels. Lengths along it are measured from its first node.
template <class T>
struct SegmentConstants {
    /// [m] The first node.
    /// @{
    T ax, ay, az;
    /// @}
    /// Unit vector towards the second node.
    /// @{
    T ux, uy, uz;
    /// @}
    T begin;        ///< [m] <= 0: start of the skeleton line, including its extension
    T end;          ///< [m] >= length: end of the skeleton line
    T length;       ///< [m] >= 0, between the nodes
    T radius;       ///< [m] at the first node
    T slope;        ///< change of the radius per metre
    T weight;       ///< factor on the contribution
    int balls = 0;  ///< number of intervals between balls in BallKernel
};

/// A sample point of a field.
template <class T>
struct Point {
    /// [m] Relative to the origin of the skeleton.
    /// @{
    T x, y, z;
    /// @}
};

/// Value of a field and its gradient.
template <class T>
struct Sample {
    T value;  ///< in units of the iso value
    /// [1/m] The gradient.
    /// @{
    T gx, gy, gz;
    /// @}
};

/// The integral of a kernel along a section of a line, in units of the local radius d, and its derivatives:
/// `h2` is the squared distance from the line, `x0` <= `x1` are the ends of the section relative to the
/// closest point.
template <class T>
struct NormalForm {
    T value;  ///< the integral
    /// Its derivatives.
    /// @{
    T d_h2, d_x0, d_x1;
    /// @}
};

/// Adds the contribution of one segment at p, for a kernel given by its normal form (quartic, Cauchy). The
/// radius d is the radius at the closest point, clamped at the ends: a cone of small slope has the value of a
/// cylinder of its local radius, and the sections of a split cylinder add up to it exactly. The gradient
/// includes the derivative of d.
template <class T, class Kernel>
COPPICE_HOST_DEVICE inline void add_segment(const Kernel& kernel, const SegmentConstants<T>& s, Point<T> p,
                                            Sample<T>& sum) {
    const T wx = p.x - s.ax, wy = p.y - s.ay, wz = p.z - s.az;
    const T t = wx * s.ux + wy * s.uy + wz * s.uz;
    const T d = s.radius + s.slope * larger(smaller(t, s.length), T(0));
    const T inv = T(1) / d;
    // Computes the distance from the line by its vector, not by |w|^2 - t^2, which cancels far from the first
    // node.
    const T qx = (wx - t * s.ux) * inv, qy = (wy - t * s.uy) * inv, qz = (wz - t * s.uz) * inv;
    const T h2 = qx * qx + qy * qy + qz * qz;
    const T x0 = (s.begin - t) * inv, x1 = (s.end - t) * inv;
    const NormalForm<T> f = kernel(h2, x0, x1);

    const T scale = s.weight * inv;
    const T d_radius = T(2) * h2 * f.d_h2 + x0 * f.d_x0 + x1 * f.d_x1;  // times -d
    const T axial = -scale * (f.d_x0 + f.d_x1 + value_within(t, s.length, s.slope) * d_radius);
    const T radial = T(2) * scale * f.d_h2;
    sum.value = sum.value + s.weight * f.value;
    sum.gx = sum.gx + (axial * s.ux + radial * qx);
    sum.gy = sum.gy + (axial * s.uy + radial * qy);
    sum.gz = sum.gz + (axial * s.uz + radial * qz);
}

}  // namespace coppice::COPPICE_KERNEL_NAMESPACE

#endif
