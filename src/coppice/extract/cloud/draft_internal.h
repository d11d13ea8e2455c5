#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "coppice/extract/cloud/graph_internal.h"
#include "coppice/extract/tree/capsule_fit.h"
#include "coppice/extract/tree/draft_tree.h"

namespace coppice::extract_internal {

/// What is more than this many times as thick as what bears it, and no longer than so many of its own radii,
/// is no branch but a few twigs, or stray points, taken for one.
inline constexpr double kThickerThanBearer = 2.3, kStout = 12;

using Feet = std::span<const std::vector<std::uint32_t>>;  ///< points of the lowest slice of each tree

struct DraftOptions {
    double step = 1;      ///< [spacing] between nodes
    double reach = 0.75;  ///< [spacing] least height of a tip above the surface of what is there
};

struct CloudDraft {
    DraftTree tree;
    FitSamples samples;         ///< all points, and the segment that each lies on
    std::uint64_t reached = 0;  ///< points to which paths lead from a foot
    std::uint32_t dropped = 0;  ///< branches that others explain
    std::uint32_t ends = 0;     ///< that were moved to where their points end
};

/// Makes trees of tubes, and finds what no tube is: grows chains from points that no segment explains, fits
/// all segments to all points, and drops what the rest explains; three times. `tubes` may be empty.
CloudDraft draft_from_cloud(DraftTree tubes, FitSamples samples, const Graph& graph, Feet feet,
                            std::span<const float> spacing, const DraftOptions& options, const Context& ctx);

/// How far points lie from the surface of a tree.
struct Cover {
    Buffer<float> distance;  ///< [m] signed, from the surface of all segments; infinite beyond a spacing
    double noise = 0;        ///< [m] standard deviation of the points about thick segments
};

/// Gives every point to the segment in whose surface it lies deepest, by its lower node, where it is no
/// farther outside than noise, spacing and radius explain; the others to none. O(n log n).
Cover claim_points(const DraftTree& tree, FitSamples& samples, std::span<const float> spacing,
                   const Context& ctx);

/// Takes away terminal branches whose points the rest of the tree explains about as well: bark, crotches, and
/// the second of two axes in one branch. Their points go to what explains them. Returns how many went.
std::uint32_t drop_needless(DraftTree& tree, FitSamples& samples, std::span<const float> spacing,
                            double noise, const Context& ctx);

/// Makes trees of loose tubes, with a root in every foot: each tube hangs by the path from its lowest point
/// on what that meets, straight over short gaps, else by a chain of nodes. Returns how many points paths
/// reach.
std::uint64_t join_tubes(DraftTree& tree, FitSamples& samples, const Graph& graph, Feet feet,
                         std::span<const float> spacing, const DraftOptions& options, const Context& ctx);

/// Adds branches for the points that no segment has: from the one farthest along paths, back along its path
/// to what is there. The points about the path are its own, so that no other branch starts from them.
void grow_chains(DraftTree& tree, FitSamples& samples, const Graph& graph, std::span<const float> spacing,
                 const Cover& cover, const DraftOptions& options, const Context& ctx);

/// Gives pieces that a few stray points made 2.3 times as thick as all that bears them nearby, and that are
/// no longer than 12 radii, the radius of what bears them. O(nodes).
void slim_clubs(DraftTree& tree);

/// Moves the starts of laterals: nodes inside of what they leave go, as no points hold them, and the axis of
/// the rest, drawn backwards, meets the axis that it leaves. O(nodes).
void settle_forks(DraftTree& tree, FitSamples& samples, const Context& ctx);

}  // namespace coppice::extract_internal
