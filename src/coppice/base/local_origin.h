#pragma once

#include <algorithm>
#include <cmath>
#include <span>

#include "coppice/base/vec.h"

namespace coppice {

/// Returns the origin relative to which coordinates in the box from `low` to `high` are stored, so that
/// floats resolve them: zero if the box is within eight times its diagonal of zero, else `anchor`, a point of
/// the box, rounded to a power of two that is a 16th to a 32nd of the diagonal. Scaling the coordinates by a
/// power of two scales the origin exactly.
inline Vec3d local_origin(Vec3d low, Vec3d high, Vec3d anchor) {
    const double size = length(high - low);
    if (!(size > 0) || std::max(length(low), length(high)) < 8 * size) return {};
    const double step = std::ldexp(1.0, std::ilogb(size) - 4);
    const auto rounded = [step](double c) { return step * std::round(c / step); };
    return {rounded(anchor.x), rounded(anchor.y), rounded(anchor.z)};
}

/// The same with the middle of the box as anchor.
inline Vec3d local_origin(Vec3d low, Vec3d high) { return local_origin(low, high, 0.5 * (low + high)); }

/// The same for the bounding box of positions, of which there is at least one. O(n).
inline Vec3d local_origin(std::span<const Vec3d> positions) {
    Vec3d low = positions[0];
    Vec3d high = low;
    for (const Vec3d& p : positions) {
        low = {std::min(low.x, p.x), std::min(low.y, p.y), std::min(low.z, p.z)};
        high = {std::max(high.x, p.x), std::max(high.y, p.y), std::max(high.z, p.z)};
    }
    return local_origin(low, high);
}

}  // namespace coppice
