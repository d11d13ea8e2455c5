#pragma once

#include <span>

#include "coppice/base/context.h"
#include "coppice/extract/prior/evidence_internal.h"
#include "coppice/extract/tree/draft_tree.h"

namespace coppice::extract_internal {

/// Moves nodes to where axes are smooth: the most likely places given how far the points leave them open, and
/// that axes bend little over twenty of their radii. Where an axis still turns sharply, it is bent open step
/// by step, whatever the points say. One sparse system for the whole tree, without fill but for forks;
/// O(nodes). Throws Cancelled.
void smooth_axes(DraftTree& tree, std::span<const NodeEvidence> evidence, const Context& ctx);

}  // namespace coppice::extract_internal
