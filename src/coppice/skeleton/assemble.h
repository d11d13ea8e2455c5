#pragma once

#include <span>

#include "coppice/base/vec.h"
#include "coppice/skeleton/skeleton.h"

namespace coppice {

// Whole skeletons, moved and put together. Places are those of the world: they have the origin in them. What
// is moved keeps its origin and its stable ids. Each throws InvalidInput where a position or a radius would
// not be finite, and takes O(n).

/// Moved by a vector [m].
Skeleton translated(const Skeleton& skeleton, Vec3d by);

/// Turned by an angle [rad] about the line through `center` [m] along `axis`, counter-clockwise seen against
/// the axis, which is of any length but 0.
Skeleton rotated(const Skeleton& skeleton, Vec3d axis, double angle, Vec3d center = {});

/// Scaled with its radii; `center` [m] stays in place. Throws InvalidInput for a factor that is not greater
/// than 0.
Skeleton scaled(const Skeleton& skeleton, double factor, Vec3d center = {});

/// The trees of all of them, in order, as one skeleton with the origin of the first. Nothing is joined to
/// anything, and stable ids are numbered anew. There must be at least one.
Skeleton joined(std::span<const Skeleton* const> parts);

}  // namespace coppice
