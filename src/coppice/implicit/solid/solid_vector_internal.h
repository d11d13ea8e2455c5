// Rows of numbers as vectors, maps, falloffs and combinations. Included only by solid_simd.cpp, once for
// every instruction set.
#if defined(COPPICE_SOLID_VECTOR_INTERNAL_H) == defined(HWY_TARGET_TOGGLE)
#ifdef COPPICE_SOLID_VECTOR_INTERNAL_H
#undef COPPICE_SOLID_VECTOR_INTERNAL_H
#else
#define COPPICE_SOLID_VECTOR_INTERNAL_H
#endif

#include <hwy/contrib/math/math-inl.h>
#include <hwy/highway.h>

#include "coppice/implicit/solid/solid_program_internal.h"

HWY_BEFORE_NAMESPACE();

namespace coppice::HWY_NAMESPACE {

namespace hn = hwy::HWY_NAMESPACE;
using Tag = hn::CappedTag<float, 16>;
using V = hn::Vec<Tag>;
constexpr std::size_t kLanes = hn::MaxLanes(Tag());
static_assert(kSolidBlock % kLanes == 0);

constexpr float kFar = 1e9f;  // [m] beyond all supports; its square is still far from infinite

struct Point {
    V x, y, z;
};
struct Sample {
    V value;
    Point gradient;
};

HWY_INLINE V splat(float x) { return hn::Set(Tag(), x); }
HWY_INLINE V zero() { return hn::Zero(Tag()); }
HWY_INLINE V load(const float* HWY_RESTRICT row, std::size_t k) { return hn::Load(Tag(), row + k); }
HWY_INLINE void store(V v, float* HWY_RESTRICT row, std::size_t k) { hn::Store(v, Tag(), row + k); }

HWY_INLINE Point load_point(const float* HWY_RESTRICT rows, std::size_t k) {
    return {load(rows, k), load(rows + kSolidBlock, k), load(rows + 2 * kSolidBlock, k)};
}
HWY_INLINE void store_point(Point p, float* HWY_RESTRICT rows, std::size_t k) {
    store(p.x, rows, k);
    store(p.y, rows + kSolidBlock, k);
    store(p.z, rows + 2 * kSolidBlock, k);
}
HWY_INLINE Sample load_sample(const float* HWY_RESTRICT rows, std::size_t k) {
    return {load(rows, k), load_point(rows + kSolidBlock, k)};
}
HWY_INLINE void store_sample(Sample s, float* HWY_RESTRICT rows, std::size_t k) {
    store(s.value, rows, k);
    store_point(s.gradient, rows + kSolidBlock, k);
}

/// Stores a range, enlarged so that it contains the exact range in spite of rounding.
HWY_INLINE void store_range(V low, V high, float* HWY_RESTRICT rows, std::size_t k) {
    const V relative = splat(1e-4f), absolute = splat(1e-5f);
    store(hn::Max(hn::Sub(hn::NegMulAdd(low, relative, low), absolute), zero()), rows, k);
    store(hn::Add(hn::MulAdd(high, relative, high), absolute), rows + kSolidBlock, k);
}

HWY_INLINE V near_or_far(V x) { return hn::IfThenElse(hn::Lt(hn::Abs(x), splat(kFar)), x, splat(kFar)); }
HWY_INLINE V hypotenuse(V a, V b) { return hn::Sqrt(hn::MulAdd(a, a, hn::Mul(b, b))); }
HWY_INLINE V squared_length(Point p) { return hn::MulAdd(p.x, p.x, hn::MulAdd(p.y, p.y, hn::Mul(p.z, p.z))); }

HWY_INLINE V row_times(const float* r, Point p) {
    return hn::MulAdd(splat(r[0]), p.x, hn::MulAdd(splat(r[1]), p.y, hn::Mul(splat(r[2]), p.z)));
}
HWY_INLINE Point through(const Rows& m, Point p) {
    return {hn::Add(row_times(m.data(), p), splat(m[3])), hn::Add(row_times(m.data() + 4, p), splat(m[7])),
            hn::Add(row_times(m.data() + 8, p), splat(m[11]))};
}
/// Transforms a gradient to the coordinates before the map: multiplies by the transpose.
HWY_INLINE Point back_through(const Rows& m, Point g) {
    const float x[3] = {m[0], m[4], m[8]}, y[3] = {m[1], m[5], m[9]}, z[3] = {m[2], m[6], m[10]};
    return {row_times(x, g), row_times(y, g), row_times(z, g)};
}
/// Returns half the sides of the box around the image of a box with half sides h.
HWY_INLINE Point reach_through(const Rows& m, Point h) {
    const float x[3] = {std::abs(m[0]), std::abs(m[1]), std::abs(m[2])};
    const float y[3] = {std::abs(m[4]), std::abs(m[5]), std::abs(m[6])};
    const float z[3] = {std::abs(m[8]), std::abs(m[9]), std::abs(m[10])};
    return {row_times(x, h), row_times(y, h), row_times(z, h)};
}
/// Returns the radius of a ball around the image of a box with half sides h.
HWY_INLINE V ball_through(const Rows& m, Point h) { return hn::Sqrt(squared_length(reach_through(m, h))); }

/// Up to kSolidBlock points, as rows of x, y and z; for ranges of boxes also their half sides.
struct Block {
    float* rows;
    Box3 box;

    void find_box(bool with_halves) {
        float* ends[2] = {&box.low.x, &box.high.x};
        for (std::size_t axis = 0; axis < 3; ++axis) {
            const float* row = rows + axis * kSolidBlock;
            V low = splat(Box3::kInfinity), high = splat(-Box3::kInfinity);
            for (std::size_t k = 0; k < kSolidBlock; k += kLanes) {
                const V v = load(row, k), half = with_halves ? load(row + 3 * kSolidBlock, k) : zero();
                low = hn::Min(low, hn::Sub(v, half));
                high = hn::Max(high, hn::Add(v, half));
            }
            ends[0][axis] = hn::GetLane(hn::MinOfLanes(Tag(), low));
            ends[1][axis] = hn::GetLane(hn::MaxOfLanes(Tag(), high));
        }
    }
};

HWY_INLINE void extend(Box3& box, Point p, Point half) {
    box.extend(Vec3{hn::GetLane(hn::MinOfLanes(Tag(), hn::Sub(p.x, half.x))),
                    hn::GetLane(hn::MinOfLanes(Tag(), hn::Sub(p.y, half.y))),
                    hn::GetLane(hn::MinOfLanes(Tag(), hn::Sub(p.z, half.z)))});
    box.extend(Vec3{hn::GetLane(hn::MaxOfLanes(Tag(), hn::Add(p.x, half.x))),
                    hn::GetLane(hn::MaxOfLanes(Tag(), hn::Add(p.y, half.y))),
                    hn::GetLane(hn::MaxOfLanes(Tag(), hn::Add(p.z, half.z)))});
}

HWY_INLINE hn::Mask<Tag> contains(const Box3& b, Point p) {
    const auto x = hn::And(hn::Ge(p.x, splat(b.low.x)), hn::Le(p.x, splat(b.high.x)));
    const auto y = hn::And(hn::Ge(p.y, splat(b.low.y)), hn::Le(p.y, splat(b.high.y)));
    const auto z = hn::And(hn::Ge(p.z, splat(b.low.z)), hn::Le(p.z, splat(b.high.z)));
    return hn::And(x, hn::And(y, z));
}

/// weight (1 - s)^2 (1 - s + share s) where the squared distance s is below 1: the laws of fields.
class Falloff {
  public:
    Falloff(float weight, float share) : weight_(weight), share_(share) {}
    explicit Falloff(const PrimitiveStep& p) : Falloff(p.weight, p.share) {}

    HWY_INLINE V value(V squared) const {
        const V s = hn::Min(squared, splat(1.0f)), t = hn::Sub(splat(1.0f), s);
        return hn::Mul(hn::Mul(splat(weight_), t), hn::Mul(t, hn::MulAdd(splat(share_), s, t)));
    }
    /// Returns the derivative by the distance, divided by the distance.
    HWY_INLINE V slope(V squared) const {
        const V s = hn::Min(squared, splat(1.0f)), t = hn::Sub(splat(1.0f), s);
        const V u = hn::MulAdd(splat(share_), hn::Sub(s, splat(1.0f / 3)), t);
        return hn::Mul(splat(-6 * weight_), hn::Mul(t, u));
    }

  private:
    float weight_, share_;
};

/// Converts the distance d in [-1, 1] from the surface of a closed shape to the distance from a skeleton at
/// depth 1 below it, in units of the end of the law soft.
HWY_INLINE V from_depth(V d) { return hn::MulAdd(splat(0.5f), d, splat(0.5f)); }

/// Returns the field of a shape at distance d, in influences. A closed one decreases from 1 at -1 to 0 at 1
/// as 1/2 - d (15 - 10 d^2 + 3 d^4) / 16, twice differentiable everywhere, or by the law soft.
HWY_INLINE V shape_falloff(bool closed, const PrimitiveStep& primitive, V d) {
    const Falloff law(primitive);
    if (!closed) {
        const V outside = hn::Max(d, zero());
        return law.value(hn::Mul(outside, outside));
    }
    d = hn::Min(hn::Max(d, splat(-1.0f)), splat(1.0f));
    if (primitive.share > 0) {
        const V x = from_depth(d);
        return law.value(hn::Mul(x, x));
    }
    const V s = hn::Mul(d, d);
    const V p = hn::MulAdd(hn::MulAdd(splat(3.0f / 16), s, splat(-10.0f / 16)), s, splat(15.0f / 16));
    return hn::NegMulAdd(d, p, splat(0.5f));
}

HWY_INLINE V shape_slope(bool closed, const PrimitiveStep& primitive, V d) {
    const Falloff law(primitive);
    d = hn::Min(hn::Max(d, splat(closed ? -1.0f : 0.0f)), splat(1.0f));
    if (!closed) return hn::Mul(d, law.slope(hn::Mul(d, d)));
    if (primitive.share > 0) {
        const V x = from_depth(d);
        return hn::Mul(hn::Mul(splat(0.5f), x), law.slope(hn::Mul(x, x)));
    }
    const V t = hn::Sub(splat(1.0f), hn::Mul(d, d));
    return hn::Mul(splat(-15.0f / 16), hn::Mul(t, t));
}

// Combinations of two values: value(a, b), and sample(a, b) into a, with gradients. A value of 0 changes
// nothing (for Least, the result is 0; bit-identical), so that skipped parts have no effect. All but
// Difference are increasing in both values.
struct Greatest {
    static constexpr bool kFalls = false;
    HWY_INLINE V value(V a, V b) const { return hn::Max(a, b); }
    HWY_INLINE void sample(Sample& a, const Sample& b) const {
        const auto other = hn::Gt(b.value, a.value);
        a = {hn::Max(a.value, b.value),
             {hn::IfThenElse(other, b.gradient.x, a.gradient.x),
              hn::IfThenElse(other, b.gradient.y, a.gradient.y),
              hn::IfThenElse(other, b.gradient.z, a.gradient.z)}};
    }
};

struct Least {
    static constexpr bool kFalls = false;
    HWY_INLINE V value(V a, V b) const { return hn::Min(a, b); }
    HWY_INLINE void sample(Sample& a, const Sample& b) const {
        const auto other = hn::Lt(b.value, a.value);
        const auto any = hn::Gt(hn::Min(a.value, b.value), zero());
        a = {hn::Min(a.value, b.value),
             {pick(any, other, a.gradient.x, b.gradient.x), pick(any, other, a.gradient.y, b.gradient.y),
              pick(any, other, a.gradient.z, b.gradient.z)}};
    }

  private:
    static HWY_INLINE V pick(hn::Mask<Tag> any, hn::Mask<Tag> other, V a, V b) {
        return hn::IfThenElseZero(any, hn::IfThenElse(other, b, a));
    }
};

/// min(a, 1 - b), at least 0.
struct Difference {
    static constexpr bool kFalls = true;
    HWY_INLINE V value(V a, V b) const { return hn::Max(hn::Min(a, hn::Sub(splat(1.0f), b)), zero()); }
    HWY_INLINE void sample(Sample& a, const Sample& b) const {
        const V left = hn::Sub(splat(1.0f), b.value);
        Least().sample(a, {left, {hn::Neg(b.gradient.x), hn::Neg(b.gradient.y), hn::Neg(b.gradient.z)}});
        a.value = hn::Max(a.value, zero());
    }
};

struct Sum {
    static constexpr bool kFalls = false;
    HWY_INLINE V value(V a, V b) const { return hn::Add(a, b); }
    HWY_INLINE void sample(Sample& a, const Sample& b) const {
        a = {hn::Add(a.value, b.value),
             {hn::Add(a.gradient.x, b.gradient.x), hn::Add(a.gradient.y, b.gradient.y),
              hn::Add(a.gradient.z, b.gradient.z)}};
    }
};

/// (a^n + b^n)^(1/n) as h (1 + t^n)^(1/n) with h the greater value and t <= 1 the ratio of the smaller to the
/// greater: no power overflows. Three values may be combined in pairs.
class Ricci {
  public:
    static constexpr bool kFalls = false;
    explicit Ricci(float exponent) : n_(exponent) {}

    HWY_INLINE V value(V a, V b) const {
        const V high = hn::Max(a, b), low = hn::Min(a, b);
        return hn::IfThenElse(hn::Gt(low, zero()), hn::Mul(high, swell(power(ratio(low, high)))), high);
    }
    HWY_INLINE void sample(Sample& a, const Sample& b) const {
        const V high = hn::Max(a.value, b.value), low = hn::Min(a.value, b.value);
        const V t = ratio(low, high), p = power(t), s = swell(p);
        const auto both = hn::Gt(low, zero());
        // The derivative by the greater value is s / (1 + t^n), by the smaller one t^(n-1) times that.
        const V of_high = hn::IfThenElse(both, hn::Div(s, hn::Add(splat(1.0f), p)), splat(1.0f));
        const V of_low = hn::IfThenElseZero(both, hn::Mul(of_high, hn::Div(p, t)));
        const auto swapped = hn::Gt(b.value, a.value);
        const V of_a = hn::IfThenElse(swapped, of_low, of_high),
                of_b = hn::IfThenElse(swapped, of_high, of_low);
        a = {hn::IfThenElse(both, hn::Mul(high, s), high),
             {hn::MulAdd(of_a, a.gradient.x, hn::Mul(of_b, b.gradient.x)),
              hn::MulAdd(of_a, a.gradient.y, hn::Mul(of_b, b.gradient.y)),
              hn::MulAdd(of_a, a.gradient.z, hn::Mul(of_b, b.gradient.z))}};
    }

  private:
    HWY_INLINE V ratio(V low, V high) const {
        return hn::Max(hn::Div(low, hn::Max(high, splat(1e-30f))), splat(1e-30f));
    }
    HWY_INLINE V power(V t) const {
        return hn::Exp(Tag(), hn::Max(hn::Mul(splat(n_), hn::Log(Tag(), t)), splat(-80.0f)));
    }
    HWY_INLINE V swell(V p) const {
        return hn::Exp(Tag(), hn::Mul(splat(1 / n_), hn::Log(Tag(), hn::Add(splat(1.0f), p))));
    }
    float n_;
};

}  // namespace coppice::HWY_NAMESPACE

HWY_AFTER_NAMESPACE();

#endif
