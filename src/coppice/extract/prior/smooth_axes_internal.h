#pragma once

#include <span>

#include "coppice/base/context.h"
#include "coppice/extract/prior/evidence_internal.h"
#include "coppice/extract/tree/initial_tree_internal.h"

namespace coppice::extract_internal {

/// Moves nodes to smooth their axes: to the most likely positions given the uncertainty of the points and a
/// prior that axes bend little over twenty of their radii. Where an axis still turns sharply, it is
/// straightened in steps, regardless of the points. Solves one sparse system for the whole tree, with fill-in
/// only at forks; O(nodes). Throws Cancelled.
void smooth_axes(InitialTree& tree, std::span<const NodeEvidence> evidence, const Context& ctx);

}  // namespace coppice::extract_internal
