#include "coppice/pipeline/repair/row_kernels_internal.h"

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "coppice/pipeline/repair/row_kernels_simd.cpp"
#include <hwy/foreach_target.h>  // includes this file once per instruction set
#include <hwy/highway.h>

HWY_BEFORE_NAMESPACE();

namespace coppice::pipeline_internal::HWY_NAMESPACE {

namespace hn = hwy::HWY_NAMESPACE;

// A plain loop, which compilers vectorise for each instruction set.
std::int32_t any_turns(const double* HWY_RESTRICT x, const double* HWY_RESTRICT y,
                       const double* HWY_RESTRICT z, std::size_t stride, std::size_t count, Vec3d apex,
                       double margin) {
    std::int32_t any = 0;
    for (std::size_t k = 0; k < count; ++k) {
        const std::size_t l = k + 1, m = k + stride + 1, n = k + stride;
        const Vec3d a{x[k], y[k], z[k]}, b{x[l], y[l], z[l]}, c{x[m], y[m], z[m]}, d{x[n], y[n], z[n]};
        const Vec3d ab = b - a, ac = c - a, ad = d - a, bc = c - b, bd = d - b;
        const Vec3d from_a = a - apex, from_b = b - apex;
        // Integers instead of branches allow the loop to be vectorised.
        const auto out = [&](Vec3d normal, Vec3d from) { return dot(normal, from) > margin ? 1 : 0; };
        any |= 1 - (out(cross(ab, ac), from_a) & out(cross(ac, ad), from_a) & out(cross(ab, ad), from_a) &
                    out(cross(bc, bd), from_b));
    }
    return any;
}

void turning_rows(const RowPoints& points, Vec3d c, double margin, std::int32_t* bad) {
    for (std::size_t j = 0; j < points.rows; ++j) {
        const std::size_t first = j * points.stride();
        bad[j] = any_turns(&points.x[first], &points.y[first], &points.z[first], points.stride(),
                           points.columns, c, margin);
    }
}

void reach_of_points(const RowPoints& points, IndexRange range, const Directions& directions, Reach& reach) {
    const hn::CappedTag<double, Directions::kCount> d;
    for (std::size_t i = 0; i < Directions::kCount; i += hn::Lanes(d)) {
        const auto u = hn::LoadU(d, &directions.x[i]), v = hn::LoadU(d, &directions.y[i]),
                   w = hn::LoadU(d, &directions.z[i]);
        auto low = hn::LoadU(d, &reach.low[i]), high = hn::LoadU(d, &reach.high[i]);
        for (std::size_t k = range.begin; k < range.end; ++k) {
            const auto x = hn::Set(d, points.x[k]), y = hn::Set(d, points.y[k]), z = hn::Set(d, points.z[k]);
            const auto at = hn::MulAdd(x, u, hn::MulAdd(y, v, hn::Mul(z, w)));
            low = hn::Min(low, at);
            high = hn::Max(high, at);
        }
        hn::StoreU(low, d, &reach.low[i]);
        hn::StoreU(high, d, &reach.high[i]);
    }
}

// There are enough points for at least one vector: the last vector overlaps the previous one.
void bounds_of_points(const RowPoints& points, Vec3d a, Vec3d axis, double length, Bounds& bounds) {
    const hn::CappedTag<double, RowPoints::kMin> d;
    const auto ax = hn::Set(d, a.x), ay = hn::Set(d, a.y), az = hn::Set(d, a.z), dx = hn::Set(d, axis.x),
               dy = hn::Set(d, axis.y), dz = hn::Set(d, axis.z), longest = hn::Set(d, length);
    auto x0 = hn::Set(d, bounds.low.x), y0 = hn::Set(d, bounds.low.y), z0 = hn::Set(d, bounds.low.z);
    auto x1 = hn::Set(d, bounds.high.x), y1 = hn::Set(d, bounds.high.y), z1 = hn::Set(d, bounds.high.z);
    auto most = hn::Set(d, bounds.distance_squared);
    const std::size_t last = points.x.size() - hn::Lanes(d);
    for (std::size_t i = 0; i < points.x.size(); i += hn::Lanes(d)) {
        const std::size_t k = std::min(i, last);
        const auto px = hn::LoadU(d, &points.x[k]), py = hn::LoadU(d, &points.y[k]),
                   pz = hn::LoadU(d, &points.z[k]);
        x0 = hn::Min(x0, px);
        y0 = hn::Min(y0, py);
        z0 = hn::Min(z0, pz);
        x1 = hn::Max(x1, px);
        y1 = hn::Max(y1, py);
        z1 = hn::Max(z1, pz);
        const auto x = hn::Sub(px, ax), y = hn::Sub(py, ay), z = hn::Sub(pz, az);
        const auto along = hn::MulAdd(x, dx, hn::MulAdd(y, dy, hn::Mul(z, dz)));
        const auto closest = hn::Min(hn::Max(along, hn::Zero(d)), longest);
        const auto u = hn::NegMulAdd(closest, dx, x), v = hn::NegMulAdd(closest, dy, y),
                   w = hn::NegMulAdd(closest, dz, z);
        most = hn::Max(most, hn::MulAdd(u, u, hn::MulAdd(v, v, hn::Mul(w, w))));
    }
    const auto min_lane = [&](auto lanes) HWY_ATTR { return hn::GetLane(hn::MinOfLanes(d, lanes)); };
    const auto max_lane = [&](auto lanes) HWY_ATTR { return hn::GetLane(hn::MaxOfLanes(d, lanes)); };
    bounds = {{min_lane(x0), min_lane(y0), min_lane(z0)},
              {max_lane(x1), max_lane(y1), max_lane(z1)},
              max_lane(most)};
}

// Rings consist of whole vectors: columns are multiples of four.
RingTurn turn_of_points(const RowPoints& points, std::size_t row, Vec3d c, const RingFrame& frame) {
    const hn::CappedTag<double, 4> d;
    const auto cx = hn::Set(d, c.x), cy = hn::Set(d, c.y), cz = hn::Set(d, c.z), zero = hn::Zero(d);
    const auto along = [&](auto x, auto y, auto z, Vec3d w) HWY_ATTR {
        return hn::MulAdd(x, hn::Set(d, w.x), hn::MulAdd(y, hn::Set(d, w.y), hn::Mul(z, hn::Set(d, w.z))));
    };
    auto forward = hn::Set(d, Bounds::kInfinity), opening = forward, above = forward, turns = zero;
    const std::size_t first = row * points.stride();
    for (std::size_t k = first; k < first + points.columns; k += hn::Lanes(d)) {
        const auto px = hn::Sub(hn::LoadU(d, &points.x[k]), cx), py = hn::Sub(hn::LoadU(d, &points.y[k]), cy),
                   pz = hn::Sub(hn::LoadU(d, &points.z[k]), cz);
        const auto qx = hn::Sub(hn::LoadU(d, &points.x[k + 1]), cx),
                   qy = hn::Sub(hn::LoadU(d, &points.y[k + 1]), cy),
                   qz = hn::Sub(hn::LoadU(d, &points.z[k + 1]), cz);
        const auto pu = along(px, py, pz, frame.u), pv = along(px, py, pz, frame.v),
                   pw = along(px, py, pz, frame.axis);
        const auto qu = along(qx, qy, qz, frame.u), qv = along(qx, qy, qz, frame.v),
                   qw = along(qx, qy, qz, frame.axis);
        const auto nu = hn::Sub(hn::Mul(pv, qw), hn::Mul(pw, qv)),
                   nv = hn::Sub(hn::Mul(pw, qu), hn::Mul(pu, qw)),
                   nw = hn::Sub(hn::Mul(pu, qv), hn::Mul(pv, qu));
        forward = hn::Min(forward, nw);
        above = hn::Min(above, pw);
        opening = hn::Min(opening, hn::Div(hn::Mul(nw, nw), hn::MulAdd(nu, nu, hn::Mul(nv, nv))));
        const auto passes = hn::And(hn::Lt(pv, zero), hn::Ge(qv, zero));
        turns = hn::Add(turns, hn::IfThenElseZero(passes, hn::Set(d, 1)));
    }
    const auto least = [&](auto lanes) HWY_ATTR { return hn::GetLane(hn::MinOfLanes(d, lanes)); };
    return {least(forward), hn::GetLane(hn::SumOfLanes(d, turns)), least(above) > 0 ? least(opening) : 0};
}

}  // namespace coppice::pipeline_internal::HWY_NAMESPACE

HWY_AFTER_NAMESPACE();

#if HWY_ONCE

namespace coppice::pipeline_internal {

HWY_EXPORT(turning_rows);
HWY_EXPORT(reach_of_points);
HWY_EXPORT(bounds_of_points);
HWY_EXPORT(turn_of_points);

void mark_rows_that_turn(const RowPoints& points, Vec3d c, double margin, std::int32_t* bad) {
    HWY_DYNAMIC_DISPATCH(turning_rows)(points, c, margin, bad);
}

void extend_reach(const RowPoints& points, IndexRange range, const Directions& directions, Reach& reach) {
    HWY_DYNAMIC_DISPATCH(reach_of_points)(points, range, directions, reach);
}

void extend_bounds(const RowPoints& points, Vec3d a, Vec3d d, double length, Bounds& bounds) {
    HWY_DYNAMIC_DISPATCH(bounds_of_points)(points, a, d, length, bounds);
}

RingTurn turn_of_ring(const RowPoints& points, std::size_t row, Vec3d c, const RingFrame& frame) {
    return HWY_DYNAMIC_DISPATCH(turn_of_points)(points, row, c, frame);
}

}  // namespace coppice::pipeline_internal

#endif
