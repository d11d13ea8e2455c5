#pragma once

#include "coppice/extract/tree/capsule_fit_internal.h"
#include "coppice/extract/tree/initial_tree_internal.h"

namespace coppice::extract_internal {

/// Removes reversals and those nodes between forks that are not needed to keep the surface within `tolerance`
/// radii, or that are closer than 0.9 radii (see `simplify_chain`). Forks closer than half a radius are
/// merged (`merge_forks`); roots and tips remain. The samples of a removed node are assigned to the next one
/// towards the tip, or to the fork that it was merged into. Uses double precision. O(n log n).
void simplify(InitialTree& tree, FitSamples& samples, double tolerance);

}  // namespace coppice::extract_internal
