#pragma once

#include "coppice/skeleton/skeleton.h"

namespace coppice::bench {

/// Returns the skeleton rotated, translated and scaled to fit the reference: iterative closest points without
/// the fifth of the points that is farthest away. Both have to be near each other.
Skeleton laid_on(const Skeleton& reference, const Skeleton& found);

}  // namespace coppice::bench
