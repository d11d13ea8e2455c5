#pragma once

#include <cstddef>
#include <cstdint>
#include <span>

#include "coppice/base/vec.h"
#include "coppice/field/kernel/kernel_constants.h"
#include "coppice/field/kernel/segment_kernel.h"
#include "coppice/implicit/field_ref.h"

namespace coppice {

/// The segments to sum, in this order.
struct SegmentList {
    const kernel::SegmentConstants<float>* segments;
    std::span<const std::uint32_t> ids;
    /// By segment; the segments of one axis are consecutive in `ids`. Unused for the plain sum.
    const std::uint32_t* axes;
    int blend;  ///< 1, 2, 4 or 8: see FieldOptions
};

/// Computes the blended sum of the segments at every point, with the widest vectors of this machine. The
/// result of a point does not depend on its index (bit-identical).
void sum_segments(const KernelConstants& kernel, const SegmentList& list, std::span<const Vec3> points,
                  std::span<FieldSample> out);

}  // namespace coppice
