#include "coppice/subdivision/ray_steps_internal.h"

#include <algorithm>
#include <limits>

#include "coppice/base/kernel/kernel_math.h"

// Vectors of a size known only at run time cannot be members of a struct; these machines use NEON or scalar
// code.
#define HWY_DISABLED_TARGETS (HWY_SVE | HWY_SVE2 | HWY_SVE_256 | HWY_SVE2_128 | HWY_RVV)
#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "coppice/subdivision/ray_steps_simd.cpp"
#include <hwy/foreach_target.h>  // includes this file once per instruction set
#include <hwy/highway.h>

#include "coppice/base/kernel/simd_lane.h"

HWY_BEFORE_NAMESPACE();

#define COPPICE_KERNEL_PER_TARGET
#undef COPPICE_KERNEL_NAMESPACE
#define COPPICE_KERNEL_NAMESPACE HWY_NAMESPACE
#include "coppice/subdivision/kernel/ray_kernel.h"

namespace coppice::HWY_NAMESPACE {

HWY_INLINE Lane load(const RayLanes::Numbers& numbers, std::size_t k) {
    return Lane(hn::Load(Tag(), &numbers[k]));
}

HWY_INLINE void store(Lane x, RayLanes::Numbers& numbers, std::size_t k) {
    hn::Store(x.v, Tag(), &numbers[k]);
}

HWY_INLINE void advance_block(RayLanes& rays, std::size_t k, const FieldSample* samples,
                              const RayRule& rule) {
    const Tag d;
    Lane value, gx, gy, gz;
    hn::LoadInterleaved4(d, &samples[k].value, value.v, gx.v, gy.v, gz.v);
    const Lane dx = load(rays.direction_x, k), dy = load(rays.direction_y, k), dz = load(rays.direction_z, k);
    const RayReading<Lane> here = read_on_ray(value, gx, gy, gz, dx, dy, dz, Lane(rule.per_level));
    RayState<Lane> ray{load(rays.t, k), load(rays.inside, k), load(rays.outside, k), load(rays.best_t, k),
                       load(rays.best_error, k)};
    const RayLimits<Lane> limits{Lane(rule.tolerance), Lane(rule.max_stretch), rule.slow};
    const RayVerdict<LaneMask> verdict = advance_ray(here, limits, ray);
    store(ray.t, rays.t, k);
    store(ray.inside, rays.inside, k);
    store(ray.outside, rays.outside, k);
    store(ray.best_t, rays.best_t, k);
    store(ray.best_error, rays.best_error, k);

    const auto code = [](RayOutcome outcome) {
        return hn::Set(IntTag(), static_cast<std::int32_t>(outcome));
    };
    const auto choose_code = [](LaneMask mask, hn::Vec<IntTag> yes, hn::Vec<IntTag> no) {
        return hn::IfThenElse(hn::RebindMask(IntTag(), mask.m), yes, no);
    };
    auto outcome = choose_code(verdict.converged, code(RayOutcome::converged), code(RayOutcome::running));
    outcome = choose_code(verdict.empty, code(RayOutcome::no_surface), outcome);
    outcome = choose_code(verdict.endless, code(RayOutcome::no_crossing), outcome);
    hn::Store(outcome, IntTag(), reinterpret_cast<std::int32_t*>(&rays.outcome[k]));

    const Lane x = load(rays.anchor_x, k) + ray.t * dx;
    const Lane y = load(rays.anchor_y, k) + ray.t * dy;
    const Lane z = load(rays.anchor_z, k) + ray.t * dz;
    hn::StoreInterleaved3(x.v, y.v, z.v, d, &rays.point[k].x);
}

HWY_FLATTEN void advance_all(RayLanes& rays, std::size_t count,
                             const std::array<FieldSample, kFieldBatch>& samples, const RayRule& rule) {
    static_assert(sizeof(Vec3) == 3 * sizeof(float) && sizeof(FieldSample) == 4 * sizeof(float));
    static_assert(kFieldBatch % hn::MaxLanes(Tag()) == 0);
    // Elements behind the last vertex are moved too: old numbers that are not read.
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
