#pragma once

#include <string>

#include "coppice/base/context.h"
#include "coppice/base/fields.h"
#include "coppice/implicit/solid/solid.h"
#include "coppice/studio/show/geometry_internal.h"

namespace coppice {

/// The axis perpendicular to a slice.
enum class SliceAxis { x, y, z };

template <>
struct EnumNames<SliceAxis> {
    static constexpr std::array<std::string_view, 3> names{"x", "y", "z"};
};

/// The plane in which a field is sampled.
struct SliceOptions {
    SliceAxis axis = SliceAxis::y;  ///< perpendicular to the plane
    double at = 0;                  ///< [m] position on that axis
    int size = 192;                 ///< samples along the longer side; in [2, 1024]
};

/// Throws InvalidInput for a position that is not finite or a size out of range.
void check_slice(const SliceOptions& options);

/// Samples the field of a solid in a plane within the extent of the field, in the format of
/// docs/library/studio-protocol.md. Throws as check_slice(); Cancelled.
std::string encode_slice(const Solid& solid, const SliceOptions& options, const GeometryHead& head,
                         const Context& ctx);

}  // namespace coppice
