#pragma once

#include <cstdint>
#include <span>

#include "coppice/base/vec.h"
#include "coppice/implicit/field_ref.h"

namespace coppice::cuda {

/// A field at points of one region.
template <class Field>
struct SamplePoints {
    Field field;                   ///< what is sampled
    std::uint32_t region;          ///< of it
    std::span<const Vec3> points;  ///< [m] where
    std::span<FieldSample> out;    ///< one per point
    COPPICE_HOST_DEVICE void operator()(std::uint32_t i) const { out[i] = field.sample(region, points[i]); }
};

}  // namespace coppice::cuda
