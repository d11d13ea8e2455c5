#include "coppice/subdivision/ray_steps_internal.h"

// Vectors of a size known only at run time cannot be members of a struct; these machines use NEON or plain
// code.
#define HWY_DISABLED_TARGETS (HWY_SVE | HWY_SVE2 | HWY_SVE_256 | HWY_SVE2_128 | HWY_RVV)
#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "coppice/subdivision/ray_steps_simd.cpp"
#include <hwy/foreach_target.h>  // includes this file once per instruction set
#include <hwy/highway.h>

HWY_BEFORE_NAMESPACE();

namespace coppice::HWY_NAMESPACE {

namespace hn = hwy::HWY_NAMESPACE;
using Tag = hn::ScalableTag<float>;
using IntTag = hn::RebindToSigned<Tag>;
using Lane = hn::Vec<Tag>;
using Mask = hn::Mask<Tag>;

constexpr float kGrowth = 1.6f;         // longest step outward: a gap between branches is not jumped over
constexpr float kShortest = 1.0f / 32;  // nothing inside down to here: the anchor does not help

HWY_INLINE Lane number(float x) { return hn::Set(Tag(), x); }
HWY_INLINE Lane half_way(Lane a, Lane b) { return hn::Mul(number(0.5f), hn::Add(a, b)); }

// What the field says at a point, in units of its level.
struct Heard {
    Lane ratio;
    Lane slope;  // of the ratio along the direction
};

// Numbers that are not finite count as far outside.
HWY_INLINE Heard hear(const RayLanes& rays, std::size_t k, const FieldSample* samples, Lane per_level) {
    const Tag d;
    Lane value, gx, gy, gz;
    hn::LoadInterleaved4(d, &samples[k].value, value, gx, gy, gz);
    const Lane zero = hn::Zero(d);
    // Zero times anything finite is zero: one test for all four numbers.
    const Lane finite = hn::Add(hn::Add(hn::Mul(zero, value), hn::Mul(zero, gx)),
                                hn::Add(hn::Mul(zero, gy), hn::Mul(zero, gz)));
    const Lane ratio = hn::Mul(value, per_level);
    const Mask counts = hn::And(hn::Eq(finite, zero), hn::Gt(ratio, zero));
    const Lane along = hn::Add(hn::Add(hn::Mul(gx, hn::Load(d, &rays.direction_x[k])),
                                       hn::Mul(gy, hn::Load(d, &rays.direction_y[k]))),
                               hn::Mul(gz, hn::Load(d, &rays.direction_z[k])));
    return {hn::IfThenElseZero(counts, ratio), hn::IfThenElseZero(counts, hn::Mul(along, per_level))};
}

// newton_rises() of project_internal.h.
HWY_INLINE Lane newton_rise(Lane ratio) {
    const Tag d;
    const Lane x = hn::Min(hn::Max(ratio, number(1e-12f)), number(1e12f));
    const Lane square = hn::Mul(hn::Mul(x, x), number(0.2f));
    const auto part =
        hn::ConvertTo(IntTag(), hn::Mul(number(0.4f), hn::ConvertTo(d, hn::BitCast(IntTag(), x))));
    Lane y = hn::BitCast(d, hn::Sub(hn::Set(IntTag(), 0x58dd8000), part));
    for (int step = 0; step < 3; ++step) {
        const Lane y2 = hn::Mul(y, y);
        const Lane y5 = hn::Mul(hn::Mul(y2, y2), y);
        y = hn::Mul(y, hn::Sub(number(1.2f), hn::Mul(square, y5)));
    }
    return hn::Mul(hn::Mul(number(2.5f), x), hn::Sub(number(1), y));
}

struct Bracket {
    Lane inside, outside, limit;
    Mask is_closed;  // a point outside is known

    HWY_INLINE Lane middle_or_limit() const {
        return hn::IfThenElse(is_closed, half_way(inside, outside), limit);
    }
};

struct Next {
    Lane t;
    Mask by_newton;
};

HWY_INLINE Next next_t(const Heard& here, Mask is_inside, Lane t, const Bracket& bracket, bool slow) {
    const Lane zero = hn::Zero(Tag());
    const Lane farthest = hn::Mul(number(kGrowth), t);
    const Lane back = half_way(bracket.inside, t);
    const Mask falls = hn::Lt(here.slope, zero);
    const Lane way = hn::Div(newton_rise(here.ratio), here.slope);
    const Lane squared = hn::Mul(t, hn::Sub(t, hn::Add(way, way)));
    const Lane root = hn::Sqrt(squared);
    const Lane aim = hn::IfThenElse(hn::And(falls, hn::Gt(squared, zero)), root,
                                    hn::IfThenElse(is_inside, farthest, back));

    const Lane middle = bracket.middle_or_limit();
    const Mask slowly = hn::Ne(number(slow ? 1.0f : 0.0f), zero);
    const Mask too_far = hn::Gt(aim, farthest);
    const Mask beyond = hn::Or(hn::Ge(aim, hn::IfThenElse(bracket.is_closed, bracket.outside, bracket.limit)),
                               hn::And(slowly, bracket.is_closed));
    const Lane outward = hn::IfThenElse(too_far, hn::Min(farthest, middle), middle);
    const Mask back_off = hn::Or(hn::Le(aim, bracket.inside), slowly);
    const Mask give_up = hn::Or(hn::And(is_inside, hn::Or(too_far, beyond)), hn::AndNot(is_inside, back_off));
    return {hn::IfThenElse(give_up, hn::IfThenElse(is_inside, outward, back), aim),
            hn::AndNot(give_up, falls)};
}

HWY_INLINE void advance_block(RayLanes& rays, std::size_t k, const FieldSample* samples,
                              const RayRule& rule) {
    const Tag d;
    const Lane zero = hn::Zero(d), one = number(1), tolerance = number(rule.tolerance);
    const Heard here = hear(rays, k, samples, number(rule.per_level));
    const Lane t = hn::Load(d, &rays.t[k]);

    const Lane error = hn::Abs(hn::Sub(here.ratio, one));
    const Lane best_error = hn::Load(d, &rays.best_error[k]);
    const Mask better = hn::Lt(error, best_error);
    hn::Store(hn::IfThenElse(better, error, best_error), d, &rays.best_error[k]);
    hn::Store(hn::IfThenElse(better, t, hn::Load(d, &rays.best_t[k])), d, &rays.best_t[k]);

    const Mask is_inside = hn::Ge(here.ratio, one);
    const Lane infinity = hn::Inf(d);
    const Lane limit = number(rule.max_stretch);
    Bracket bracket{hn::Load(d, &rays.inside[k]), hn::Load(d, &rays.outside[k]), limit, {}};
    const Mask is_endless = hn::And(hn::And(is_inside, hn::Ge(t, limit)), hn::Eq(bracket.outside, infinity));
    bracket.inside = hn::IfThenElse(is_inside, t, bracket.inside);
    bracket.outside = hn::IfThenElse(is_inside, bracket.outside, t);
    bracket.is_closed = hn::Lt(bracket.outside, infinity);
    hn::Store(bracket.inside, d, &rays.inside[k]);
    hn::Store(bracket.outside, d, &rays.outside[k]);

    const Next next = next_t(here, is_inside, t, bracket, rule.slow);
    // Newton's error is squared by each step, so the one after a short step need not be seen.
    const Lane step = hn::Div(hn::Sub(next.t, t), t);
    const Mask is_short = hn::And(next.by_newton, hn::Le(hn::Mul(step, step), tolerance));
    const Mask is_narrow = hn::And(bracket.is_closed, hn::Le(hn::Sub(bracket.outside, bracket.inside),
                                                             hn::Mul(tolerance, bracket.outside)));
    const Mask is_empty =
        hn::AndNot(is_inside, hn::And(hn::Eq(bracket.inside, zero), hn::Lt(t, number(kShortest))));

    const auto code = [](RayOutcome outcome) {
        return hn::Set(IntTag(), static_cast<std::int32_t>(outcome));
    };
    const auto choose = [](Mask mask, hn::Vec<IntTag> yes, hn::Vec<IntTag> no) {
        return hn::IfThenElse(hn::RebindMask(IntTag(), mask), yes, no);
    };
    auto outcome =
        choose(hn::Or(is_short, is_narrow), code(RayOutcome::converged), code(RayOutcome::running));
    outcome = choose(is_empty, code(RayOutcome::no_surface), outcome);
    outcome = choose(is_endless, code(RayOutcome::no_crossing), outcome);
    hn::Store(outcome, IntTag(), reinterpret_cast<std::int32_t*>(&rays.outcome[k]));

    const Lane stay = hn::IfThenElse(hn::Or(is_empty, is_endless), one, next.t);
    hn::Store(stay, d, &rays.t[k]);
    const auto along = [&](const RayLanes::Numbers& anchor, const RayLanes::Numbers& direction) {
        return hn::Add(hn::Load(d, &anchor[k]), hn::Mul(stay, hn::Load(d, &direction[k])));
    };
    hn::StoreInterleaved3(along(rays.anchor_x, rays.direction_x), along(rays.anchor_y, rays.direction_y),
                          along(rays.anchor_z, rays.direction_z), d, &rays.point[k].x);
}

HWY_FLATTEN void advance_all(RayLanes& rays, std::size_t count,
                             const std::array<FieldSample, kFieldBatch>& samples, const RayRule& rule) {
    static_assert(sizeof(Vec3) == 3 * sizeof(float) && sizeof(FieldSample) == 4 * sizeof(float));
    static_assert(kFieldBatch % hn::MaxLanes(Tag()) == 0);
    // What lies behind the last vertex is moved too: old numbers that nobody reads.
    for (std::size_t k = 0; k < count; k += hn::MaxLanes(Tag())) advance_block(rays, k, samples.data(), rule);
}

}  // namespace coppice::HWY_NAMESPACE

HWY_AFTER_NAMESPACE();

#if HWY_ONCE

namespace coppice {

HWY_EXPORT(advance_all);

void advance_rays(RayLanes& rays, std::size_t count, const std::array<FieldSample, kFieldBatch>& samples,
                  const RayRule& rule) {
    HWY_DYNAMIC_DISPATCH(advance_all)(rays, count, samples, rule);
}

}  // namespace coppice

#endif
