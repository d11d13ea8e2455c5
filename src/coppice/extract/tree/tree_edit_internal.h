#pragma once

#include <cstdint>
#include <optional>
#include <utility>
#include <vector>

#include "coppice/base/id.h"
#include "coppice/extract/extract_result.h"
#include "coppice/extract/tree/capsule_fit_internal.h"
#include "coppice/extract/tree/initial_tree_internal.h"

namespace coppice::extract_internal {

/// Returns for each node the child that continues its axis, or kNoIndex: a fixed one, otherwise the one with
/// the longest path to a tip; the first of equal ones. O(nodes).
std::vector<std::uint32_t> axis_children(const InitialTree& tree);

/// Connects each tip to the node that it touches and cuts the resulting loop at its thinnest place. With
/// `keep` the cut end is extended to the node that it was cut from, so that the axis stays complete. Sorts
/// the tree; returns the new index of every old node.
std::vector<std::uint32_t> cut_loops(InitialTree& tree,
                                     const std::vector<std::pair<std::uint32_t, std::uint32_t>>& loops,
                                     bool keep);

/// Removes terminal branches that rise above the surface of their parent branch by less than `least` times
/// its radius; their samples are assigned to the node of the fork. Returns the number of removed branches.
/// O(nodes).
std::uint32_t prune_stubs(InitialTree& tree, FitSamples& samples, double least);

/// Removes nodes at which a branch reverses its direction: forks have moved past them. Their samples are
/// assigned to the next node tipward. Returns the number of removed nodes. O(nodes).
std::uint32_t remove_reversals(InitialTree& tree, FitSamples& samples);

/// Merges a fork with the next fork rootward if their distance is less than `factor` times the larger radius:
/// the thicker one keeps its position and gets the children of both and the samples between. Returns the
/// number of removed forks. O(nodes).
std::uint32_t merge_forks(InitialTree& tree, FitSamples& samples, double factor);

/// Moves every end along its axis to the end of its samples minus its radius; if they end in a flat face,
/// onto that face, and ignores the samples of the face. Returns the number of ends moved by more than a tenth
/// of their radius. O(samples + nodes).
std::uint32_t extend_ends(InitialTree& tree, FitSamples& samples);

/// Attaches trees to another tree if an end is within `reach` radii of the axis of one of its segments,
/// closest first. The radius is the larger one of both, and an end is at most 2.5 times as thick as the
/// segment. Returns the number of attachments. Nodes may precede their parents afterwards.
std::uint32_t join_trees(InitialTree& tree, double reach, const Context& ctx);

/// Makes the lowest end of every tree along axis `up` its root; of the tree closest to `wanted`, the closest
/// end. Nodes may precede their parents afterwards.
void choose_roots(InitialTree& tree, int up, std::optional<Vec3d> wanted);

/// Returns how well its samples support each node; stores the mean over all samples in `residual`.
std::vector<NodeConfidence> rate_nodes(const InitialTree& tree, const FitSamples& samples, float& residual,
                                       const Context& ctx);

}  // namespace coppice::extract_internal
