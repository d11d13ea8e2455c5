#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "coppice/extract/points/graph_internal.h"
#include "coppice/extract/prior/radii_internal.h"
#include "coppice/extract/tree/capsule_fit.h"
#include "coppice/extract/tree/draft_tree.h"

namespace coppice::extract_internal {

/// What is more than this many times as thick as what bears it, and no longer than so many of its own radii,
/// is no branch but a few twigs, or outliers, taken for one.
inline constexpr double kThickerThanBearer = 2.3, kStout = 12;

inline constexpr int kShortFit = 4;             // iterations of a fit of what was fitted before
inline constexpr double kNodeTolerance = 0.02;  // [radius] to which nodes are needed

struct DraftOptions {
    double step = 1;        ///< [spacing] between nodes
    double reach = 0.75;    ///< [spacing] least height of a tip above the surface of what is there
    double detail = 0;      ///< [m] from all surfaces, up to which leaves get no twig
    double cover = 1;       ///< [spacing] the same of other points, for narrow branches
    double area_limit = 0;  ///< see believe_radii
    bool narrow = false;    ///< branches follow their paths and are thin, however their points spread
};

/// What a draft is made from.
struct DraftCloud {
    const Graph& graph;
    StemBases bases;                 ///< of the trees whose stem was not measured
    std::span<const float> spacing;  ///< [m] per point
    std::span<const Vec3> outward;   ///< per point how branches grow, of length 1
    DraftOptions options;
    std::span<const std::uint8_t> leaf = {};  ///< per point whether it is of a leaf; empty where none is

    PathCost cost(std::span<const Vec3> positions) const { return {spacing, positions, outward}; }
};

struct CloudDraft {
    DraftTree tree;
    FitSamples samples;         ///< all points, and the segment that each lies on
    std::uint64_t reached = 0;  ///< points to which paths lead from a stem base
    std::uint32_t pruned = 0;   ///< branches that others explain
    std::uint32_t ends = 0;     ///< that were moved to where their points end
    RadiusBelief belief;        ///< of the radii; after `settle_draft`
};

/// Makes trees of tubes, and finds what no tube is: grows chains from points that no segment explains, fits
/// all segments to all points, and prunes what the rest explains; three times. `tubes` may be empty.
CloudDraft draft_from_cloud(DraftTree tubes, FitSamples samples, const DraftCloud& cloud, const Context& ctx);

/// Makes of a draft what is to be believed: smooth axes, radii by evidence and prior, paths through what
/// cannot be resolved. Points of leaves, which the draft need not have seen, say nothing of radii.
void settle_draft(CloudDraft& draft, const DraftCloud& cloud, const Context& ctx);

/// How far points lie from the surface of a tree.
struct PointDistances {
    Buffer<float> distance;  ///< [m] signed, from the surface of all segments; infinite far outside
    double noise = 0;        ///< [m] standard deviation of the points about thick segments
};

/// Fits all segments to all points.
void fit_draft(CloudDraft& draft, int iterations, const Context& ctx);

/// The nodes without parents, in order.
std::vector<std::uint32_t> roots_of(const DraftTree& tree);

/// Points of a stem base that no segment has belong to the one of these roots that is nearest.
void assign_stem_bases(CloudDraft& draft, StemBases bases, std::span<const std::uint32_t> roots);

/// How far outside of a surface a point is still on it: by what is more.
struct Tolerance {
    double spacings = 0.3;  ///< [spacing]
    double radii = 0.2;     ///< [radius]
    double metres = 0;      ///< [m]
};

/// Gives every point to the segment in whose surface it lies deepest, by its tipward node, where it is no
/// farther outside than the tolerance or the noise; the others to none. O(n log n).
PointDistances assign_points(const DraftTree& tree, FitSamples& samples, std::span<const float> spacing,
                             const Context& ctx, const Tolerance& tolerance = {});

/// Takes away terminal branches whose points the rest of the tree explains about as well: bark, crotches, and
/// the second of two axes in one branch. Their points go to what explains them. Returns how many went.
std::uint32_t prune_redundant(DraftTree& tree, FitSamples& samples, std::span<const float> spacing,
                              double noise, const Context& ctx);

/// Makes trees of loose tubes: each is attached by the path from its lowest point to what that meets,
/// straight over short gaps, else by a chain of nodes. `standing` are the roots of those that are trees
/// already; `add_roots` makes one for every stem base. Paths start there and on measured stems. Returns how
/// many points paths reach.
std::uint64_t attach_tubes(DraftTree& tree, FitSamples& samples, const DraftCloud& cloud,
                           std::span<const std::uint32_t> standing, bool add_roots, const Context& ctx);

/// Adds branches for the points that no segment has: from the one farthest along paths, back along its path
/// to what is there. The points about the path are its own, so that no other branch starts from them.
void grow_chains(DraftTree& tree, FitSamples& samples, const DraftCloud& cloud,
                 const PointDistances& distances, const Context& ctx);

/// Gives pieces that a few outliers made 2.3 times as thick as all that bears them nearby, and that are no
/// longer than 12 radii, the radius of what bears them. O(nodes).
void correct_swollen_radii(DraftTree& tree);

/// Moves the starts of laterals: nodes inside of what they leave go, as no points hold them, and the axis of
/// the rest, drawn backwards, meets the axis that it leaves. O(nodes).
void reattach_laterals(DraftTree& tree, FitSamples& samples, const Context& ctx);

}  // namespace coppice::extract_internal
