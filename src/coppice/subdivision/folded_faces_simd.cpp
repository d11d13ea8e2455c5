#include "coppice/subdivision/folded_faces_internal.h"

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "coppice/subdivision/folded_faces_simd.cpp"
#include <hwy/foreach_target.h>  // includes this file once per instruction set
#include <hwy/highway.h>

HWY_BEFORE_NAMESPACE();

namespace coppice::HWY_NAMESPACE {

// A plain loop, which compilers vectorise for each instruction set.
bool mark_all(const FaceColumns& columns, std::size_t count, FaceLimits limits,
              const std::int32_t* HWY_RESTRICT starts, std::int32_t* HWY_RESTRICT bad) {
    const float* HWY_RESTRICT x = columns.x;
    const float* HWY_RESTRICT y = columns.y;
    const float* HWY_RESTRICT z = columns.z;
    const float* HWY_RESTRICT u = columns.u;
    const float* HWY_RESTRICT v = columns.v;
    const float* HWY_RESTRICT w = columns.w;
    const std::size_t row = columns.row;
    std::int32_t any = 0;
    for (std::size_t k = 0; k < count; ++k) {
        const std::size_t b = k + 1, c = k + row + 1, d = k + row;
        const Vec3 outward{(u[k] + u[b]) + (u[c] + u[d]), (v[k] + v[b]) + (v[c] + v[d]),
                           (w[k] + w[b]) + (w[c] + w[d])};
        const std::int32_t is_bad =
            starts[k] & bad_face({x[k], y[k], z[k]}, {x[b], y[b], z[b]}, {x[c], y[c], z[c]},
                                 {x[d], y[d], z[d]}, outward, limits);
        bad[k] = is_bad;
        any |= is_bad;
    }
    return any != 0;
}

}  // namespace coppice::HWY_NAMESPACE

HWY_AFTER_NAMESPACE();

#if HWY_ONCE

namespace coppice {

HWY_EXPORT(mark_all);

bool mark_bad_faces(const FaceColumns& columns, std::size_t count, FaceLimits limits,
                    const std::int32_t* starts, std::int32_t* bad) {
    return HWY_DYNAMIC_DISPATCH(mark_all)(columns, count, limits, starts, bad);
}

}  // namespace coppice

#endif
