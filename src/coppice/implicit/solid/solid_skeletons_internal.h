// Squared distances from skeletons. Included only by solid_simd.cpp, once for every instruction set.
#if defined(COPPICE_SOLID_SKELETONS_INTERNAL_H) == defined(HWY_TARGET_TOGGLE)
#ifdef COPPICE_SOLID_SKELETONS_INTERNAL_H
#undef COPPICE_SOLID_SKELETONS_INTERNAL_H
#else
#define COPPICE_SOLID_SKELETONS_INTERNAL_H
#endif

#include "coppice/implicit/solid/solid_vector_internal.h"

HWY_BEFORE_NAMESPACE();

namespace coppice::HWY_NAMESPACE {

/// Squared distance from a skeleton, and the vector from its nearest point: half the gradient of the squared
/// distance.
struct Nearest {
    V squared;
    Point away;
};

HWY_INLINE V clamp(V x, float low, float high) { return hn::Min(hn::Max(x, splat(low)), splat(high)); }
HWY_INLINE Nearest nearest_by(Point away) { return {squared_length(away), away}; }

/// Converts a vector in the half plane through the axis, outward `e` and up `dz`.
HWY_INLINE Nearest nearest_around(Point q, V rho, V e, V dz) {
    const V per_rho = hn::Div(e, hn::Max(rho, splat(1e-30f)));
    return {hn::MulAdd(e, e, hn::Mul(dz, dz)), {hn::Mul(per_rho, q.x), hn::Mul(per_rho, q.y), dz}};
}

struct PointSkeleton {
    HWY_INLINE Nearest operator()(Point q) const { return nearest_by(q); }
};

/// A line from the origin up to height c.
class SegmentSkeleton {
  public:
    explicit SegmentSkeleton(const PrimitiveStep& p) : height_(p.c) {}
    HWY_INLINE Nearest operator()(Point q) const {
        return nearest_by({q.x, q.y, hn::Sub(q.z, clamp(q.z, 0, height_))});
    }

  private:
    float height_;
};

/// A circle of radius a about z.
class CircleSkeleton {
  public:
    explicit CircleSkeleton(const PrimitiveStep& p) : radius_(p.a) {}
    HWY_INLINE Nearest operator()(Point q) const {
        const V rho = hypotenuse(q.x, q.y);
        return nearest_around(q, rho, hn::Sub(rho, splat(radius_)), q.z);
    }

  private:
    float radius_;
};

/// A solid cylinder of radius a, from z = 0 to c; a disc if c is 0.
class CylinderSkeleton {
  public:
    explicit CylinderSkeleton(const PrimitiveStep& p) : radius_(p.a), height_(p.c) {}
    HWY_INLINE Nearest operator()(Point q) const {
        const V rho = hypotenuse(q.x, q.y);
        return nearest_around(q, rho, hn::Max(hn::Sub(rho, splat(radius_)), zero()),
                              hn::Sub(q.z, clamp(q.z, 0, height_)));
    }

  private:
    float radius_, height_;
};

/// A solid box with half sides a, b, c.
class BoxSkeleton {
  public:
    explicit BoxSkeleton(const PrimitiveStep& p) : a_(p.a), b_(p.b), c_(p.c) {}
    HWY_INLINE Nearest operator()(Point q) const {
        return nearest_by({hn::Sub(q.x, clamp(q.x, -a_, a_)), hn::Sub(q.y, clamp(q.y, -b_, b_)),
                           hn::Sub(q.z, clamp(q.z, -c_, c_))});
    }

  private:
    float a_, b_, c_;
};

/// A solid cone of radius a at z = 0 and b at z = c.
class ConeSkeleton {
  public:
    explicit ConeSkeleton(const PrimitiveStep& p)
        : low_(p.a),
          high_(p.b),
          height_(p.c),
          slant_(p.b - p.a),
          per_length_(1 / (slant_ * slant_ + height_ * height_)) {}

    HWY_INLINE Nearest operator()(Point q) const {
        const V rho = hypotenuse(q.x, q.y);
        // Distances to the lower disc, the upper disc and the lateral surface: the minimum of the three,
        // unless inside.
        V e = hn::Max(hn::Sub(rho, splat(low_)), zero()), dz = q.z;
        V best = hn::MulAdd(e, e, hn::Mul(dz, dz));
        const V above = hn::Sub(q.z, splat(height_));
        take(hn::Max(hn::Sub(rho, splat(high_)), zero()), above, e, dz, best);
        const V out = hn::Sub(rho, splat(low_));
        const V along =
            hn::Mul(hn::MulAdd(out, splat(slant_), hn::Mul(q.z, splat(height_))), splat(per_length_));
        const V t = clamp(along, 0, 1);
        take(hn::NegMulAdd(t, splat(slant_), out), hn::NegMulAdd(t, splat(height_), q.z), e, dz, best);
        const auto between = hn::And(hn::Ge(q.z, zero()), hn::Le(above, zero()));
        const auto within = hn::Le(hn::Mul(out, splat(height_)), hn::Mul(q.z, splat(slant_)));
        const auto outside = hn::Not(hn::And(between, within));
        return nearest_around(q, rho, hn::IfThenElseZero(outside, e), hn::IfThenElseZero(outside, dz));
    }

  private:
    static HWY_INLINE void take(V other_e, V other_dz, V& e, V& dz, V& best) {
        const V s = hn::MulAdd(other_e, other_e, hn::Mul(other_dz, other_dz));
        const auto nearer = hn::Lt(s, best);
        e = hn::IfThenElse(nearer, other_e, e);
        dz = hn::IfThenElse(nearer, other_dz, dz);
        best = hn::IfThenElse(nearer, s, best);
    }
    float low_, high_, height_, slant_, per_length_;
};

HWY_INLINE Nearest nowhere() { return {splat(1e30f), {zero(), zero(), zero()}}; }

HWY_INLINE void take_nearer(const EdgeStep& e, Point q, Nearest& nearest) {
    const Point w{hn::Sub(q.x, splat(e.ax)), hn::Sub(q.y, splat(e.ay)), hn::Sub(q.z, splat(e.az))};
    const V t = clamp(hn::Mul(row_times(&e.dx, w), splat(e.inverse_length_squared)), 0, 1);
    const Point away{hn::NegMulAdd(t, splat(e.dx), w.x), hn::NegMulAdd(t, splat(e.dy), w.y),
                     hn::NegMulAdd(t, splat(e.dz), w.z)};
    const V s = squared_length(away);
    const auto nearer = hn::Lt(s, nearest.squared);
    nearest = {
        hn::IfThenElse(nearer, s, nearest.squared),
        {hn::IfThenElse(nearer, away.x, nearest.away.x), hn::IfThenElse(nearer, away.y, nearest.away.y),
         hn::IfThenElse(nearer, away.z, nearest.away.z)}};
}

/// A planar polygon in z = 0: inside if a ray along x crosses an odd number of edges.
class PolygonSkeleton {
  public:
    PolygonSkeleton(const PrimitiveStep& p, const EdgeStep* edges)
        : edges_(edges), first_(p.first), count_(p.count) {}

    HWY_INLINE Nearest operator()(Point q) const {
        Nearest nearest = nowhere();
        for (std::uint32_t i = first_; i < first_ + count_; ++i) take_nearer(edges_[i], q, nearest);
        V odd = zero();
        for (std::uint32_t i = first_; i < first_ + count_; ++i) odd = hn::Xor(odd, crossed(i, q));
        const auto inside = hn::Ne(odd, zero());
        const auto zero_inside = [&](V v) { return hn::IfThenElse(inside, zero(), v); };
        const Point away{zero_inside(nearest.away.x), zero_inside(nearest.away.y), q.z};
        return {squared_length(away), away};
    }

  private:
    /// Returns 1 where the ray crosses the edge, otherwise 0.
    HWY_INLINE V crossed(std::uint32_t i, Point q) const {
        const EdgeStep& e = edges_[i];
        // Uses the end as stored in the next edge, so that a corner is crossed exactly once.
        const float end_y = edges_[i + 1 < first_ + count_ ? i + 1 : first_].ay;
        const auto starts_above = hn::Gt(splat(e.ay), q.y), ends_above = hn::Gt(splat(end_y), q.y);
        const auto spans = hn::Xor(starts_above, ends_above);
        const V side = hn::Sub(hn::Mul(hn::Sub(q.y, splat(e.ay)), splat(e.dx)),
                               hn::Mul(hn::Sub(q.x, splat(e.ax)), splat(e.dy)));
        const auto left = e.dy > 0 ? hn::Gt(side, zero()) : hn::Lt(side, zero());
        return hn::IfThenElseZero(hn::And(spans, left), splat(1.0f));
    }

    const EdgeStep* edges_;
    std::uint32_t first_, count_;
};

}  // namespace coppice::HWY_NAMESPACE

HWY_AFTER_NAMESPACE();

#endif
