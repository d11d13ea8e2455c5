#pragma once

#include <cstdint>
#include <span>

#include "coppice/extract/cloud_tree_internal.h"

namespace coppice::extract_internal {

/// Drops branches of nodes from `first` on that reach less than `reach` beyond where they part, along paths
/// whose cost at each point is `level`, or hold fewer than three points. What leaves a node before `first`, a
/// tube, must reach somewhat farther. Points of what goes fall to what it left. Returns how many went.
std::uint32_t prune_twigs(CloudTree& tree, std::uint32_t first, std::span<const float> level, double reach);

/// Drops what leaves a clean tube, shows none itself, and ends within `length` radii of its surface: bark,
/// and the crotches of forks. Returns how many branches went.
std::uint32_t prune_roughness(CloudTree& tree, double length);

/// Moves tips and roots along their axes to where their points end; returns how many.
std::uint32_t extend_ends(CloudTree& tree, std::span<const Vec3> points);

/// Moves the starts of laterals: the axis of a lateral, drawn backwards, meets the axis that it leaves lower
/// than where points tell the two apart. Returns how many moved.
std::uint32_t repair_forks(CloudTree& tree);

/// Makes radii trustworthy: along axes they fall from the root to the tip, weighted by the points of the
/// fits; where there are no fits they follow the allometry of the tree itself, r ~ (length beyond)^e.
void settle_radii(CloudTree& tree, double least_radius);

}  // namespace coppice::extract_internal
