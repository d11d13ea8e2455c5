#pragma once

#include "coppice/skeleton/skeleton.h"

namespace coppice::bench {

/// The skeleton turned, moved and scaled as a whole, so that it lies on the reference as well as it can:
/// closest points again and again, leaving out the fifth that is farthest off. Both have to be near each
/// other.
Skeleton laid_on(const Skeleton& reference, const Skeleton& found);

}  // namespace coppice::bench
