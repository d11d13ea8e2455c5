// Included by Highway sources, once for every instruction set, after <hwy/highway.h>: a function can only be
// inlined into code of the same instruction set.
#if defined(HIGHWAY_HWY_HIGHWAY_H_) || defined(HWY_NAMESPACE)

#include <cstddef>
#include <cstdint>
#include <type_traits>

HWY_BEFORE_NAMESPACE();

namespace coppice::HWY_NAMESPACE {

namespace hn = hwy::HWY_NAMESPACE;
using Tag = hn::ScalableTag<float>;
using IntTag = hn::RebindToSigned<Tag>;
constexpr std::size_t kLanes = hn::MaxLanes(Tag());

/// One boolean per lane.
struct LaneMask {
    hn::Mask<Tag> m;
};
HWY_INLINE LaneMask operator&(LaneMask a, LaneMask b) { return {hn::And(a.m, b.m)}; }
HWY_INLINE LaneMask operator|(LaneMask a, LaneMask b) { return {hn::Or(a.m, b.m)}; }
HWY_INLINE LaneMask operator!(LaneMask a) { return {hn::Not(a.m)}; }

/// A SIMD vector of floats, which the formulas in *_kernel.h use in place of a float.
struct Lane {
    hn::Vec<Tag> v;

    HWY_INLINE Lane() = default;
    template <class Number>
    requires std::is_arithmetic_v<Number> HWY_INLINE explicit Lane(Number x)
        : v(hn::Set(Tag(), static_cast<float>(x))) {}
    HWY_INLINE explicit Lane(hn::Vec<Tag> x) : v(x) {}
};

HWY_INLINE Lane operator+(Lane a, Lane b) { return Lane(hn::Add(a.v, b.v)); }
HWY_INLINE Lane operator-(Lane a, Lane b) { return Lane(hn::Sub(a.v, b.v)); }
HWY_INLINE Lane operator-(Lane a) { return Lane(hn::Neg(a.v)); }
HWY_INLINE Lane operator*(Lane a, Lane b) { return Lane(hn::Mul(a.v, b.v)); }
HWY_INLINE Lane operator/(Lane a, Lane b) { return Lane(hn::Div(a.v, b.v)); }
HWY_INLINE LaneMask operator<(Lane a, Lane b) { return {hn::Lt(a.v, b.v)}; }
HWY_INLINE LaneMask operator<=(Lane a, Lane b) { return {hn::Le(a.v, b.v)}; }
HWY_INLINE LaneMask operator>(Lane a, Lane b) { return {hn::Gt(a.v, b.v)}; }
HWY_INLINE LaneMask operator>=(Lane a, Lane b) { return {hn::Ge(a.v, b.v)}; }
HWY_INLINE LaneMask operator==(Lane a, Lane b) { return {hn::Eq(a.v, b.v)}; }
HWY_INLINE Lane smaller(Lane a, Lane b) { return Lane(hn::Min(a.v, b.v)); }
HWY_INLINE Lane larger(Lane a, Lane b) { return Lane(hn::Max(a.v, b.v)); }
HWY_INLINE float least(Lane a) { return hn::GetLane(hn::MinOfLanes(Tag(), a.v)); }
HWY_INLINE float largest(Lane a) { return hn::GetLane(hn::MaxOfLanes(Tag(), a.v)); }
HWY_INLINE Lane square_root(Lane a) { return Lane(hn::Sqrt(a.v)); }
HWY_INLINE Lane absolute(Lane a) { return Lane(hn::Abs(a.v)); }
HWY_INLINE Lane choose(LaneMask mask, Lane yes, Lane no) { return Lane(hn::IfThenElse(mask.m, yes.v, no.v)); }
HWY_INLINE Lane value_where(LaneMask mask, Lane value) { return Lane(hn::IfThenElseZero(mask.m, value.v)); }
HWY_INLINE Lane guess_by_bits(std::int32_t from, float factor, Lane x) {
    const auto bits = hn::ConvertTo(Tag(), hn::BitCast(IntTag(), x.v));
    const auto part = hn::ConvertTo(IntTag(), hn::Mul(hn::Set(Tag(), factor), bits));
    return Lane(hn::BitCast(Tag(), hn::Sub(hn::Set(IntTag(), from), part)));
}

}  // namespace coppice::HWY_NAMESPACE

HWY_AFTER_NAMESPACE();

#endif
