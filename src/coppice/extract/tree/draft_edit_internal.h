#pragma once

#include <cstdint>
#include <optional>
#include <utility>
#include <vector>

#include "coppice/extract/extract_result.h"
#include "coppice/extract/tree/capsule_fit.h"
#include "coppice/extract/tree/draft_tree.h"

namespace coppice::extract_internal {

/// For every node the child that continues its axis, or kNoParent: a fixed one, or else the one with the
/// longest way to a tip. Of equal ones the first. O(nodes).
std::vector<std::uint32_t> axis_children(const DraftTree& tree);

/// Closes each way round from a tip to the node it touches, and cuts it where it is thinnest. With `keep` the
/// cut end is led on to the node it was cut from, so that nothing of the axis is missing. Sorts the tree;
/// returns the new index of every old node.
std::vector<std::uint32_t> cut_loops(DraftTree& tree,
                                     const std::vector<std::pair<std::uint32_t, std::uint32_t>>& loops,
                                     bool keep);

/// Takes away terminal branches that rise above the surface of what they leave by less than `least` of its
/// radius; their samples go to the node where they left. Returns their number. O(nodes).
std::uint32_t prune_stubs(DraftTree& tree, FitSamples& samples, double least);

/// Takes away nodes at which a branch turns back on itself: forks that have slid past them. Their samples go
/// to the next node tipward. Returns their number. O(nodes).
std::uint32_t remove_reversals(DraftTree& tree, FitSamples& samples);

/// Makes one of a fork and the next fork rootward of it where they are nearer than `factor` times the larger
/// radius: the thicker one stays in place and has the children of both, and the samples of what lies between.
/// Returns the number of forks that went. O(nodes).
std::uint32_t merge_forks(DraftTree& tree, FitSamples& samples, double factor);

/// Moves every end along its axis to where its samples end, less its radius; where they end in a flat face,
/// into that face, whose samples are then left out. Returns the number of ends moved by more than a tenth of
/// their radius. O(samples + nodes).
std::uint32_t extend_ends(DraftTree& tree, FitSamples& samples);

/// Attaches trees whose end lies within `reach` radii of the axis of another tree's segment, nearest first;
/// radii of the thicker of both, and an end is at most 2.5 times as thick as the segment. Returns their
/// number. Nodes may come before their parents afterwards.
std::uint32_t join_trees(DraftTree& tree, double reach, const Context& ctx);

/// Makes the end of every tree that is lowest along axis `up` its root; of the tree nearest to `wanted` the
/// end nearest to that. Nodes may come before their parents afterwards.
void choose_roots(DraftTree& tree, int up, std::optional<Vec3d> wanted);

/// How well the samples that each node has support it; `residual` takes the mean of all samples.
std::vector<NodeConfidence> rate_nodes(const DraftTree& tree, const FitSamples& samples, float& residual,
                                       const Context& ctx);

}  // namespace coppice::extract_internal
