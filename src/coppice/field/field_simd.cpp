#include "coppice/field/field_simd_internal.h"

#include <algorithm>
#include <cmath>
#include <type_traits>

#include "coppice/base/error.h"
#include "coppice/base/kernel/fast_atan2.h"

// Vectors with a size known only at run time cannot be members of a struct; such machines use NEON or scalar
// code.
#define HWY_DISABLED_TARGETS (HWY_SVE | HWY_SVE2 | HWY_SVE_256 | HWY_SVE2_128 | HWY_RVV)
#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "coppice/field/field_simd.cpp"
#include <hwy/foreach_target.h>  // includes this file once per instruction set
#include <hwy/highway.h>

#include "coppice/base/kernel/simd_lane.h"

HWY_BEFORE_NAMESPACE();

#define COPPICE_KERNEL_PER_TARGET
#undef COPPICE_KERNEL_NAMESPACE
#define COPPICE_KERNEL_NAMESPACE HWY_NAMESPACE
#include "coppice/field/kernel/segment_kernel.h"

#include "coppice/field/kernel/ball_kernel.h"
#include "coppice/field/kernel/cauchy_kernel.h"
#include "coppice/field/kernel/quartic_kernel.h"
#include "coppice/field/kernel/scalis_kernel.h"

#include "coppice/field/kernel/axis_sum_kernel.h"

namespace coppice::HWY_NAMESPACE {

/// Returns x if it is at least `low`, otherwise 0.
HWY_INLINE Lane value_from(Lane x, Lane low) { return value_where(x >= low, x); }

HWY_INLINE Lane value_within(Lane x, Lane high, Lane value) {
    return value_where((x > Lane(0)) & (x < high), value);
}

HWY_INLINE Lane upper_angle(Lane y, Lane x) {
    const Lane size = absolute(x);
    const Lane z = smaller(y, size) / larger(y, size);
    const Lane s = z * z;
    Lane p(kArctan[0]);
    for (std::size_t k = 1; k < kArctan.size(); ++k) p = p * s + Lane(kArctan[k]);
    p = p * z;
    p = choose(y > size, Lane(1.57079632679) - p, p);
    return choose(x < Lane(0), Lane(3.14159265359) - p, p);
}

template <class K>
HWY_INLINE void add_entry(const K& formula, const SegmentList& list, std::size_t i, Point<Lane> p,
                          Sample<Lane>& sum) {
    const kernel::SegmentConstants<float>& s = list.segments[list.ids[i]];
    const SegmentConstants<Lane> broadcast{
        Lane(s.ax),  Lane(s.ay),     Lane(s.az),     Lane(s.ux),    Lane(s.uy),     Lane(s.uz), Lane(s.begin),
        Lane(s.end), Lane(s.length), Lane(s.radius), Lane(s.slope), Lane(s.weight), s.balls};
    add_contribution(formula, broadcast, p, sum);
}

/// Sums the whole list at kLanes points, given as x y z of each; the sums stay in registers.
template <int n, class K>
HWY_INLINE void sum_block(const K& formula, const SegmentList& list, const float* HWY_RESTRICT points,
                          float* HWY_RESTRICT out) {
    const Tag d;
    Point<Lane> p;
    hn::LoadInterleaved3(d, points, p.x.v, p.y.v, p.z.v);
    const Sample<Lane> nothing{Lane(0.0f), Lane(0.0f), Lane(0.0f), Lane(0.0f)};
    Sample<Lane> sum = nothing;
    const std::size_t count = list.ids.size();
    if constexpr (n > 1) {
        Sample<Lane> total = nothing;
        std::uint32_t axis = list.axes[list.ids[0]];
        for (std::size_t i = 0; i < count; ++i) {
            const std::uint32_t a = list.axes[list.ids[i]];
            if (a != axis) {
                axis = a;
                add_power<n>(sum, total);
                sum = nothing;
            }
            add_entry(formula, list, i, p, sum);
        }
        add_power<n>(sum, total);
        sum = take_root<n>(total);
    } else {
        for (std::size_t i = 0; i < count; ++i) add_entry(formula, list, i, p, sum);
        // Rounding may make an empty sum slightly negative, which is invalid for roots and logarithms.
        sum.value = larger(sum.value, Lane(0.0f));
    }
    hn::StoreInterleaved4(sum.value.v, sum.gx.v, sum.gy.v, sum.gz.v, d, out);
}

template <int n, class K>
HWY_FLATTEN void sum_all(const K& formula, const SegmentList& list, std::span<const Vec3> points,
                         std::span<FieldSample> out) {
    static_assert(sizeof(Vec3) == 3 * sizeof(float) && sizeof(FieldSample) == 4 * sizeof(float));
    const std::size_t count = points.size();
    Vec3 padded[kLanes];
    FieldSample result[kLanes];
    const bool whole = count >= kLanes;
    if (!whole) {
        std::copy_n(points.data(), count, padded);
        std::fill_n(padded + count, kLanes - count, count > 0 ? points.back() : Vec3{});
    }
    for (std::size_t i = 0; i < count; i += kLanes) {
        // The last block of many overlaps the previous one: computing identical values twice is cheaper than
        // a copy. There is a single call, so that the compiler cannot round whole and padded blocks
        // differently.
        const std::size_t first = whole ? std::min(i, count - kLanes) : 0;
        sum_block<n>(formula, list, whole ? &points[first].x : &padded[0].x,
                     whole ? &out[first].value : &result[0].value);
    }
    if (!whole) std::copy_n(result, count, out.data());
}

/// The norm of a single axis is its plain sum.
template <class K>
HWY_INLINE void sum_axes(const K& formula, const SegmentList& list, std::span<const Vec3> points,
                         std::span<FieldSample> out) {
    const auto& ids = list.ids;
    const bool many = list.blend > 1 && !ids.empty() && list.axes[ids.front()] != list.axes[ids.back()];
    switch (many ? list.blend : 1) {
        case 2:
            return sum_all<2>(formula, list, points, out);
        case 4:
            return sum_all<4>(formula, list, points, out);
        case 8:
            return sum_all<8>(formula, list, points, out);
        default:
            return sum_all<1>(formula, list, points, out);
    }
}

void sum_points(const KernelConstants& constants, const SegmentList& list, std::span<const Vec3> points,
                std::span<FieldSample> out) {
    switch (constants.kernel) {
        case Kernel::quartic:
            return sum_axes(QuarticKernel<Lane>(constants.shape, constants.weight), list, points, out);
        case Kernel::cauchy:
            return sum_axes(CauchyKernel<Lane>(constants.shape, constants.weight), list, points, out);
        case Kernel::scalis:
            return sum_axes(ScalisKernel<Lane>(), list, points, out);
        case Kernel::balls:
            return sum_axes(BallKernel<Lane>(constants.shape, constants.weight), list, points, out);
    }
}

}  // namespace coppice::HWY_NAMESPACE

HWY_AFTER_NAMESPACE();

#if HWY_ONCE

namespace coppice {

HWY_EXPORT(sum_points);

void sum_segments(const KernelConstants& kernel, const SegmentList& list, std::span<const Vec3> points,
                  std::span<FieldSample> out) {
    COPPICE_ASSERT(points.size() == out.size());
    HWY_DYNAMIC_DISPATCH(sum_points)(kernel, list, points, out);
}

}  // namespace coppice

#endif
