#pragma once

#include <span>

#include "coppice/base/vec.h"
#include "coppice/skeleton/skeleton.h"

namespace coppice {

// Transformations and union of whole skeletons. Positions are in world space: they include the origin.
// Transformed skeletons keep their origin and stable ids. All functions throw InvalidInput if a position or a
// radius would not be finite, and are O(n).

/// Returns the skeleton translated by a vector [m].
Skeleton translated(const Skeleton& skeleton, Vec3d by);

/// Returns the skeleton rotated by an angle [rad] about the line through `center` [m] along `axis`,
/// counter-clockwise when seen against the axis, which may have any length except 0.
Skeleton rotated(const Skeleton& skeleton, Vec3d axis, double angle, Vec3d center = {});

/// Returns the skeleton scaled together with its radii; `center` [m] is the fixed point. Throws InvalidInput
/// for a factor that is not greater than 0.
Skeleton scaled(const Skeleton& skeleton, double factor, Vec3d center = {});

/// Returns the trees of all skeletons, in order, as one skeleton with the origin of the first. Trees are not
/// connected, and stable ids are renumbered. Requires at least one skeleton.
Skeleton joined(std::span<const Skeleton* const> parts);

}  // namespace coppice
