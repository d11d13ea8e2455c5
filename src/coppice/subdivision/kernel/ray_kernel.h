// Included once for scalar numbers, and again by ray_steps_simd.cpp for every instruction set: see
// kernel_math.h.
#if !defined(COPPICE_SUBDIVISION_RAY_KERNEL_H) || defined(COPPICE_KERNEL_PER_TARGET)
#define COPPICE_SUBDIVISION_RAY_KERNEL_H

#include "coppice/base/kernel/kernel_math.h"

namespace coppice::COPPICE_KERNEL_NAMESPACE {

/// Returns (x^(2/5) - 1) over its derivative, for x >= 0 and clamped to where that is finite: Newton's step
/// on a field's value^(2/5). x^(-2/5) is computed from an initial estimate by the exponent and Newton's
/// method without division.
template <class T>
COPPICE_HOST_DEVICE inline T newton_rise(T ratio) {
    const T x = smaller(larger(ratio, T(1e-12f)), T(1e12f));
    const T square = x * x * T(0.2f);
    T y = guess_by_bits(0x58dd8000, 0.4f, x);
    for (int step = 0; step < 3; ++step) {
        const T y2 = y * y;
        y = y * (T(1.2f) - square * (y2 * y2 * y));
    }
    return T(2.5f) * x * (T(1) - y);
}

/// Value of a field at a point of a ray, in units of its level; numbers that are not finite count as far
/// outside.
template <class T>
struct RayReading {
    T ratio;  ///< value / level
    T slope;  ///< of the ratio along the direction
};

/// Returns the reading of a sample: value, gradient, and the direction of the ray.
template <class T>
COPPICE_HOST_DEVICE inline RayReading<T> read_on_ray(T value, T gx, T gy, T gz, T dx, T dy, T dz,
                                                     T per_level) {
    // Zero times a finite number is zero: one test for all four numbers.
    const T zero(0);
    const T finite = (zero * value + zero * gx) + (zero * gy + zero * gz);
    const T ratio = value * per_level;
    const auto counts = (finite == zero) & (ratio > zero);
    return {value_where(counts, ratio), value_where(counts, (gx * dx + gy * dy + gz * dz) * per_level)};
}

/// A vertex on its ray, anchor + t direction; the surface is between `inside` and `outside`.
template <class T>
struct RayState {
    T t;           ///< current parameter; initially 1
    T inside;      ///< initially 0: the anchor is assumed inside until a vertex comes close to it
    T outside;     ///< infinite until a point outside is known
    T best_t;      ///< parameter at which the field was closest to its level
    T best_error;  ///< the difference there; initially infinite
};

/// Length and accuracy of rays.
template <class T>
struct RayLimits {
    T tolerance;    ///< of t, as a fraction
    T max_stretch;  ///< maximum t
    bool slow;      ///< bisect the bracket instead of using Newton's method
};

/// Outcome of a step; if all are false, the vertex continues. An empty or endless vertex is at its initial
/// position.
template <class Mask>
struct RayVerdict {
    Mask converged;  ///< on the surface
    Mask empty;      ///< no point inside down to the anchor
    Mask endless;    ///< no point outside up to the end of the ray
};

/// Returns the step of Newton's method on value^(2/5) as a function of t^2, limited to the bracket.
template <class T, class Mask>
COPPICE_HOST_DEVICE inline T next_on_ray(const RayReading<T>& here, Mask is_inside, Mask is_closed,
                                         const RayLimits<T>& limits, const RayState<T>& ray,
                                         Mask& by_newton) {
    constexpr float kGrowth = 1.6f;  // longest step outward: does not jump over a gap between branches
    const T t = ray.t;
    const T farthest = T(kGrowth) * t;
    const T back = T(0.5f) * (ray.inside + t);
    const auto falls = here.slope < T(0);
    const T way = newton_rise(here.ratio) / here.slope;
    const T squared = t * (t - (way + way));
    const T aim = choose(falls & (squared > T(0)), square_root(squared), choose(is_inside, farthest, back));

    const T middle = choose(is_closed, T(0.5f) * (ray.inside + ray.outside), limits.max_stretch);
    const auto slowly = T(limits.slow ? 1.0f : 0.0f) > T(0);
    const auto too_far = aim > farthest;
    const auto beyond = (aim >= choose(is_closed, ray.outside, limits.max_stretch)) | (slowly & is_closed);
    const T outward = choose(too_far, smaller(farthest, middle), middle);
    const auto back_off = (aim <= ray.inside) | slowly;
    const auto give_up = (is_inside & (too_far | beyond)) | ((!is_inside) & back_off);
    by_newton = (!give_up) & falls;
    return choose(give_up, choose(is_inside, outward, back), aim);
}

/// Moves a vertex by one step from the reading at its position.
template <class T>
COPPICE_HOST_DEVICE inline auto advance_ray(const RayReading<T>& here, const RayLimits<T>& limits,
                                            RayState<T>& ray) {
    constexpr float kShortest = 1.0f / 32;  // parameter to which no point is inside: the anchor does not help
    constexpr float kInfinity = std::numeric_limits<float>::infinity();
    const T error = absolute(here.ratio - T(1));
    const auto better = error < ray.best_error;
    ray.best_error = choose(better, error, ray.best_error);
    ray.best_t = choose(better, ray.t, ray.best_t);

    using Mask = decltype(error < error);
    const T t = ray.t;
    const Mask is_inside = here.ratio >= T(1);
    const Mask is_endless = is_inside & (t >= limits.max_stretch) & (ray.outside == T(kInfinity));
    ray.inside = choose(is_inside, t, ray.inside);
    ray.outside = choose(is_inside, ray.outside, t);
    const Mask is_closed = ray.outside < T(kInfinity);

    Mask by_newton = is_closed;
    const T next = next_on_ray(here, is_inside, is_closed, limits, ray, by_newton);
    // Newton's error is squared by each step, so the step after a short one need not be evaluated.
    const T step = (next - t) / t;
    const Mask is_short = by_newton & (step * step <= limits.tolerance);
    const Mask is_narrow = is_closed & (ray.outside - ray.inside <= limits.tolerance * ray.outside);
    const Mask is_empty = (!is_inside) & (ray.inside == T(0)) & (t < T(kShortest));
    ray.t = choose(is_empty | is_endless, T(1), next);
    const Mask is_there = is_short | is_narrow;
    return RayVerdict<Mask>{is_there, is_empty, is_endless};
}

}  // namespace coppice::COPPICE_KERNEL_NAMESPACE

#endif
