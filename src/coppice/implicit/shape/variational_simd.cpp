#include <array>
#include <cstddef>

#include "coppice/implicit/shape/variational_internal.h"

// Vectors with a size known only at run time cannot be in arrays; such machines use NEON or scalar code.
#define HWY_DISABLED_TARGETS (HWY_SVE | HWY_SVE2 | HWY_SVE_256 | HWY_SVE2_128 | HWY_RVV)
#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "coppice/implicit/shape/variational_simd.cpp"
#include <hwy/foreach_target.h>  // includes this file once per instruction set
#include <hwy/highway.h>

HWY_BEFORE_NAMESPACE();

namespace coppice::HWY_NAMESPACE {

namespace hn = hwy::HWY_NAMESPACE;

CubeSums sum_cubes_here(const CubeCenters& centers, const Vec3d& p) {
    const hn::ScalableTag<double> d;
    const std::size_t lanes = hn::Lanes(d), n = centers.weight.size();
    const auto px = hn::Set(d, p.x), py = hn::Set(d, p.y), pz = hn::Set(d, p.z), tiny = hn::Set(d, 1e-300);
    auto value = hn::Zero(d), gx = value, gy = value, gz = value, trace = value;
    auto xx = value, xy = value, xz = value, yy = value, yz = value, zz = value;
    for (std::size_t i = 0; i < n; i += lanes) {
        // Weights beyond the last centre are read as zero.
        const std::size_t left = n - i;
        const auto load = [&](std::span<const double> column) HWY_ATTR {
            return left >= lanes ? hn::LoadU(d, &column[i])
                                 : hn::MaskedLoad(hn::FirstN(d, left), d, &column[i]);
        };
        const auto vx = hn::Sub(px, load(centers.x)), vy = hn::Sub(py, load(centers.y));
        const auto vz = hn::Sub(pz, load(centers.z)), w = load(centers.weight);
        const auto squared = hn::MulAdd(vx, vx, hn::MulAdd(vy, vy, hn::Mul(vz, vz)));
        const auto r = hn::Sqrt(squared);
        const auto wr = hn::Mul(w, r), by_r = hn::Div(w, hn::Max(r, tiny));
        value = hn::MulAdd(wr, squared, value);
        gx = hn::MulAdd(wr, vx, gx);
        gy = hn::MulAdd(wr, vy, gy);
        gz = hn::MulAdd(wr, vz, gz);
        trace = hn::Add(trace, wr);
        const auto wx = hn::Mul(by_r, vx), wy = hn::Mul(by_r, vy);
        xx = hn::MulAdd(wx, vx, xx);
        xy = hn::MulAdd(wx, vy, xy);
        xz = hn::MulAdd(wx, vz, xz);
        yy = hn::MulAdd(wy, vy, yy);
        yz = hn::MulAdd(wy, vz, yz);
        zz = hn::MulAdd(hn::Mul(by_r, vz), vz, zz);
    }
    const auto sum = [&](hn::Vec<decltype(d)> v) HWY_ATTR { return hn::GetLane(hn::SumOfLanes(d, v)); };
    const double t = sum(trace);
    return {sum(value),        {3 * sum(gx), 3 * sum(gy), 3 * sum(gz)},
            3 * (sum(xx) + t), 3 * sum(xy),
            3 * sum(xz),       3 * (sum(yy) + t),
            3 * sum(yz),       3 * (sum(zz) + t)};
}

}  // namespace coppice::HWY_NAMESPACE

HWY_AFTER_NAMESPACE();

#if HWY_ONCE

namespace coppice {

HWY_EXPORT(sum_cubes_here);

CubeSums sum_cubes(const CubeCenters& centers, Vec3d p) {
    return HWY_DYNAMIC_DISPATCH(sum_cubes_here)(centers, p);
}

}  // namespace coppice

#endif
