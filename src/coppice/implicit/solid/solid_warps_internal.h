// Warps: the position of a point before it was twisted, tapered or bent. Included only by solid_simd.cpp,
// once for every instruction set.
#if defined(COPPICE_SOLID_WARPS_INTERNAL_H) == defined(HWY_TARGET_TOGGLE)
#ifdef COPPICE_SOLID_WARPS_INTERNAL_H
#undef COPPICE_SOLID_WARPS_INTERNAL_H
#else
#define COPPICE_SOLID_WARPS_INTERNAL_H
#endif

#include "coppice/implicit/solid/solid_vector_internal.h"

HWY_BEFORE_NAMESPACE();

namespace coppice::HWY_NAMESPACE {

// Every warp has three functions for the lanes at k of a block: points(at, before, k) writes the points to
// rows 0 to 2 of `before` and the data of pull_back to rows 3 to 5; pull_back(before, k, g) transforms the
// gradient at those points to the frame; ranges(at, before, k) maps boxes to boxes, with half sides in rows 3
// to 5.

class Twist {
  public:
    explicit Twist(const WarpStep& w) : w_(w) {}

    HWY_INLINE void points(const Block& at, Block& before, std::size_t k) const {
        Point c, trig;
        turn(through(w_.rows, load_point(at.rows, k)), c, trig);
        store_point(c, before.rows, k);
        store_point(trig, before.rows + 3 * kSolidBlock, k);
    }

    HWY_INLINE Point pull_back(const Block& before, std::size_t k, Point g) const {
        const Point p = load_point(before.rows, k), trig = load_point(before.rows + 3 * kSolidBlock, k);
        const V turned = hn::Sub(hn::Mul(g.x, p.y), hn::Mul(g.y, p.x));
        return {hn::Sub(hn::Mul(trig.x, g.x), hn::Mul(trig.y, g.y)),
                hn::MulAdd(trig.y, g.x, hn::Mul(trig.x, g.y)), hn::MulAdd(splat(w_.rate), turned, g.z)};
    }

    HWY_INLINE void ranges(const Block& at, Block& before, std::size_t k) const {
        const Point h = reach_through(w_.rows, load_point(at.rows + 3 * kSolidBlock, k));
        Point c, trig;
        turn(through(w_.rows, load_point(at.rows, k)), c, trig);
        const V half = hypotenuse(h.x, h.y), out = hn::Add(hypotenuse(c.x, c.y), half);
        // Rotated by at most |rate| h.z, a point moves by that angle times its distance from the axis, or
        // across the axis at most.
        const V turned = hn::Mul(out, hn::Min(hn::Mul(splat(std::abs(w_.rate)), h.z), splat(2.0f)));
        const V across = hn::Add(half, turned);
        store_point(c, before.rows, k);
        store_point({across, across, h.z}, before.rows + 3 * kSolidBlock, k);
    }

  private:
    /// trig: cosine and sine of the angle.
    HWY_INLINE void turn(Point p, Point& straight, Point& trig) const {
        const V a = hn::Min(hn::Max(hn::Mul(splat(w_.rate), p.z), splat(-2e4f)), splat(2e4f));
        const V c = hn::Cos(Tag(), a), s = hn::Sin(Tag(), a);
        straight = {hn::MulAdd(c, p.x, hn::Mul(s, p.y)), hn::Sub(hn::Mul(c, p.y), hn::Mul(s, p.x)), p.z};
        trig = {c, s, zero()};
    }

    const WarpStep& w_;
};

class Taper {
  public:
    explicit Taper(const WarpStep& w) : w_(w) {}

    HWY_INLINE void points(const Block& at, Block& before, std::size_t k) const {
        const Point p = through(w_.rows, load_point(at.rows, k));
        const V per_scale = hn::Div(splat(1.0f), scale(p.z));
        store_point({hn::Mul(p.x, per_scale), hn::Mul(p.y, per_scale), p.z}, before.rows, k);
        const V t = hn::Mul(p.z, splat(w_.height));
        const auto sloping = hn::And(hn::Gt(t, zero()), hn::Lt(t, splat(1.0f)));
        const V slope = hn::IfThenElseZero(sloping, hn::Mul(splat(w_.rate * w_.height), per_scale));
        store_point({per_scale, slope, zero()}, before.rows + 3 * kSolidBlock, k);
    }

    HWY_INLINE Point pull_back(const Block& before, std::size_t k, Point g) const {
        const Point p = load_point(before.rows, k), by = load_point(before.rows + 3 * kSolidBlock, k);
        const V across = hn::MulAdd(g.x, p.x, hn::Mul(g.y, p.y));
        return {hn::Mul(g.x, by.x), hn::Mul(g.y, by.x), hn::NegMulAdd(across, by.y, g.z)};
    }

    HWY_INLINE void ranges(const Block& at, Block& before, std::size_t k) const {
        const Point c = through(w_.rows, load_point(at.rows, k));
        const Point h = reach_through(w_.rows, load_point(at.rows + 3 * kSolidBlock, k));
        const V one = splat(1.0f), per_scale = hn::Div(one, scale(c.z));
        const V a = hn::Div(one, scale(hn::Sub(c.z, h.z))), b = hn::Div(one, scale(hn::Add(c.z, h.z)));
        const V most = hn::Max(a, b), spread = hn::Sub(most, hn::Min(a, b));
        store_point({hn::Mul(c.x, per_scale), hn::Mul(c.y, per_scale), c.z}, before.rows, k);
        store_point({hn::MulAdd(h.x, most, hn::Mul(hn::Abs(c.x), spread)),
                     hn::MulAdd(h.y, most, hn::Mul(hn::Abs(c.y), spread)), h.z},
                    before.rows + 3 * kSolidBlock, k);
    }

  private:
    HWY_INLINE V scale(V z) const {
        const V t = hn::Min(hn::Max(hn::Mul(z, splat(w_.height)), zero()), splat(1.0f));
        return hn::MulAdd(t, splat(w_.rate), splat(1.0f));
    }

    const WarpStep& w_;
};

/// The arc is in the plane of x and z, about (1 / curvature, 0).
class Bend {
  public:
    explicit Bend(const WarpStep& w) : w_(w) {}

    HWY_INLINE void points(const Block& at, Block& before, std::size_t k) const {
        Point straight, turn;
        V r;
        unbend(through(w_.rows, load_point(at.rows, k)), straight, turn, r);
        store_point(straight, before.rows, k);
        store_point(turn, before.rows + 3 * kSolidBlock, k);
    }

    HWY_INLINE Point pull_back(const Block& before, std::size_t k, Point g) const {
        const Point turn = load_point(before.rows + 3 * kSolidBlock, k);
        const V along = hn::Mul(turn.z, g.z);
        return {hn::MulAdd(turn.x, g.x, hn::Mul(turn.y, along)), g.y,
                hn::Sub(hn::Mul(turn.x, along), hn::Mul(turn.y, g.x))};
    }

    HWY_INLINE void ranges(const Block& at, Block& before, std::size_t k) const {
        const Point c = through(w_.rows, load_point(at.rows, k));
        const Point h = reach_through(w_.rows, load_point(at.rows + 3 * kSolidBlock, k));
        Point straight, turn;
        V r;
        unbend(c, straight, turn, r);
        const V reach = hypotenuse(h.x, h.z);
        // Lengths along the arc grow by arc radius / r towards the centre.
        const V least = hn::Sub(r, reach), arc_radius = splat(1 / w_.rate);
        const V grown = hn::Max(hn::Div(arc_radius, hn::Max(least, splat(1e-6f / w_.rate))), splat(1.0f));
        const auto torn =
            hn::Or(hn::Lt(least, hn::Mul(splat(0.01f), arc_radius)), hn::Ge(reach, cut_distance(c, r)));
        const V everything = splat(kFar);
        store_point(straight, before.rows, k);
        store_point({hn::IfThenElse(torn, everything, reach), h.y,
                     hn::IfThenElse(torn, everything, hn::Mul(reach, grown))},
                    before.rows + 3 * kSolidBlock, k);
    }

  private:
    /// turn: cosine and sine of the local rotation angle, and the growth of lengths along the arc; r: the
    /// distance from the centre of the arc.
    HWY_INLINE void unbend(Point p, Point& straight, Point& turn, V& r) const {
        const V arc_radius = splat(1 / w_.rate);
        const V u = hn::Sub(arc_radius, p.x);
        r = hn::Max(hypotenuse(u, p.z), hn::Mul(splat(1e-6f), arc_radius));
        const V angle = compute_angle(p.z, u);
        const auto before = hn::Lt(angle, zero()), after = hn::Gt(angle, splat(w_.angle));
        const V per_r = hn::Div(splat(1.0f), r);
        // arc radius - r, without the difference of almost equal numbers.
        const V twice = hn::Add(arc_radius, arc_radius);
        const V inward = hn::Sub(hn::Mul(p.x, hn::Sub(twice, p.x)), hn::Mul(p.z, p.z));
        const V arc_x = hn::Div(inward, hn::Add(arc_radius, r)), arc_z = hn::Mul(angle, arc_radius);
        const V c = splat(w_.cosine), s = splat(w_.sine);
        const V end_x = hn::Add(hn::Sub(hn::Mul(p.x, c), hn::Mul(p.z, s)), splat(w_.end_shift_x));
        const V end_z = hn::Add(hn::MulAdd(p.z, c, hn::Mul(p.x, s)), splat(w_.height - w_.end_shift_z));
        straight = {pick(before, after, p.x, end_x, arc_x), p.y, pick(before, after, p.z, end_z, arc_z)};
        turn = {pick(before, after, splat(1.0f), c, hn::Mul(u, per_r)),
                pick(before, after, zero(), s, hn::Mul(p.z, per_r)),
                pick(before, after, splat(1.0f), splat(1.0f), hn::Mul(arc_radius, per_r))};
    }

    static HWY_INLINE V pick(hn::Mask<Tag> before, hn::Mask<Tag> after, V start, V end, V arc) {
        return hn::IfThenElse(before, start, hn::IfThenElse(after, end, arc));
    }

    /// Returns the angle about the centre from the start of the arc; the region opposite its middle belongs
    /// half to the start and half to the end.
    HWY_INLINE V compute_angle(V z, V u) const {
        constexpr float kPi = 3.14159265f;
        const V a = hn::Abs(z), b = hn::Abs(u);
        const V high = hn::Max(a, b), low = hn::Min(a, b);
        V angle = hn::Atan(Tag(), hn::Div(low, hn::Max(high, splat(1e-30f))));
        angle = hn::IfThenElse(hn::Gt(a, b), hn::Sub(splat(kPi / 2), angle), angle);
        angle = hn::IfThenElse(hn::Lt(u, zero()), hn::Sub(splat(kPi), angle), angle);
        angle = hn::IfThenElse(hn::Lt(z, zero()), hn::Neg(angle), angle);
        const auto behind = hn::Lt(angle, splat(w_.angle / 2 - kPi));
        return hn::IfThenElse(behind, hn::Add(angle, splat(2 * kPi)), angle);
    }

    /// Returns the distance from the half line where start and end meet.
    HWY_INLINE V cut_distance(Point p, V r) const {
        const V u = hn::Sub(splat(1 / w_.rate), p.x);
        const float c = -std::cos(w_.angle / 2), s = -std::sin(w_.angle / 2);
        const V along = hn::MulAdd(u, splat(c), hn::Mul(p.z, splat(s)));
        const V across = hn::Abs(hn::Sub(hn::Mul(u, splat(s)), hn::Mul(p.z, splat(c))));
        return hn::IfThenElse(hn::Gt(along, zero()), across, r);
    }

    const WarpStep& w_;
};

}  // namespace coppice::HWY_NAMESPACE

HWY_AFTER_NAMESPACE();

#endif
