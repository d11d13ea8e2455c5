#pragma once

#include "coppice/extract/tree/capsule_fit.h"
#include "coppice/extract/tree/draft_tree.h"

namespace coppice::extract_internal {

/// Removes reversals, and takes away the nodes between forks that its surface does not need to stay within
/// `tolerance` radii, or that lie nearer together than 0.9 radii (see `simplify_chain`). Forks nearer
/// together than half a radius become one (`merge_forks`); roots and tips stay. The samples of a node that
/// goes fall to the next one towards the tip, or to the fork that it is part of. In double precision. O(n log
/// n).
void simplify(DraftTree& tree, FitSamples& samples, double tolerance);

}  // namespace coppice::extract_internal
