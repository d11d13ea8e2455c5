#pragma once

#include "coppice/extract/tree/capsule_fit.h"
#include "coppice/extract/tree/draft_tree.h"

namespace coppice::extract_internal {

/// Unfolds the tree, and takes away the nodes between forks that its surface does not need to stay within
/// `tolerance` radii, or that lie nearer together than 0.9 radii (see `simplify_chain`). Roots, forks and
/// tips stay where they are, however near to each other. The samples of a node that goes fall to the next one
/// towards the tip. In double precision. O(n log n).
void simplify(DraftTree& tree, FitSamples& samples, double tolerance);

}  // namespace coppice::extract_internal
