#pragma once

#include <cstdint>
#include <span>

#include "coppice/base/vec.h"
#include "coppice/implicit/field_ref.h"

namespace coppice::cuda {

/// Samples a field at points of one region.
template <class Field>
struct SamplePoints {
    Field field;                   ///< sampled field
    std::uint32_t region;          ///< region of the points
    std::span<const Vec3> points;  ///< [m] sample points
    std::span<FieldSample> out;    ///< one per point
    COPPICE_HOST_DEVICE void operator()(std::uint32_t i) const { out[i] = field.sample(region, points[i]); }
};

}  // namespace coppice::cuda
