#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "coppice/extract/points/graph_internal.h"
#include "coppice/extract/prior/radii_internal.h"
#include "coppice/extract/tree/capsule_fit_internal.h"
#include "coppice/extract/tree/initial_tree_internal.h"

namespace coppice::extract_internal {

/// A section more than this many times as thick as its supporting branch and at most this many of its own
/// radii long is not a branch, but twigs or outliers mistaken for one.
inline constexpr double kThickerThanBearer = 2.3, kStout = 12;

inline constexpr int kShortFit = 4;             // number of iterations of a fit of segments fitted before
inline constexpr double kNodeTolerance = 0.02;  // [radius] tolerance of the removal of nodes

struct InitialTreeOptions {
    double step = 1;        ///< [spacing] distance between nodes
    double reach = 0.75;    ///< [spacing] minimum height of a tip above the existing surface
    double detail = 0;      ///< [m] maximum distance from all surfaces of leaves without a twig
    double cover = 1;       ///< [spacing] the same of other points, for narrow branches
    double area_limit = 0;  ///< see believe_radii
    bool narrow = false;  ///< whether branches follow their paths and are thin, regardless of the scatter of
                          ///< their points
};

/// Input of the initial tree.
struct CloudInput {
    const Graph& graph;
    StemBases bases;                 ///< bases of the trees without a measured stem
    std::span<const float> spacing;  ///< [m] per point
    std::span<const Vec3> outward;   ///< unit direction of growth per point
    InitialTreeOptions options;
    std::span<const std::uint8_t> leaf = {};  ///< per point, whether it is on a leaf; empty without leaves
    std::span<const float> next = {};  ///< [m] per point, distance to those next to it; for `finalize_tree`

    PathCost cost(std::span<const Vec3> positions) const { return {spacing, positions, outward}; }
};

struct FittedTree {
    InitialTree tree;
    FitSamples samples;         ///< all points, and the segment of each
    std::uint64_t reached = 0;  ///< number of points reached by paths from a stem base
    std::uint32_t pruned = 0;   ///< number of removed branches with points explained by others
    std::uint32_t ends = 0;     ///< number of ends moved to the end of their points
    RadiusEstimate estimate;    ///< estimates of the radii; set by `finalize_tree`
};

/// Builds trees from tubes and completes them in three rounds: grows chains from points that no segment
/// explains, fits all segments to all points, and prunes branches with points explained by the others.
/// `tubes` may be empty.
FittedTree build_initial_tree(InitialTree tubes, FitSamples samples, const CloudInput& cloud,
                              const Context& ctx);

/// Finalizes an initial tree: smooths its axes, estimates the radii from evidence and prior, and adds paths
/// through unresolved regions. Points of leaves, which the initial tree need not contain, have no influence
/// on radii.
void finalize_tree(FittedTree& initial, const CloudInput& cloud, const Context& ctx);

/// Distances of points from the surface of a tree.
struct PointDistances {
    Buffer<float> distance;  ///< [m] signed distance from the surface of all segments; infinity far outside
    double noise = 0;        ///< [m] standard deviation of the points about thick segments
};

/// Fits all segments to all points.
void fit_initial_tree(FittedTree& initial, int iterations, const Context& ctx);

/// Returns the nodes without parents, in order.
std::vector<std::uint32_t> find_roots(const InitialTree& tree);

/// Assigns the points of each stem base without a segment to the closest of these roots.
void assign_stem_bases(FittedTree& initial, StemBases bases, std::span<const std::uint32_t> roots);

/// Maximum distance outside of a surface of a point on it: the largest of the three values.
struct Tolerance {
    double spacings = 0.3;  ///< [spacing]
    double radii = 0.2;     ///< [radius]
    double metres = 0;      ///< [m]
};

/// Assigns every point to the segment with the smallest signed distance, by its tipward node, if that is
/// within the tolerance or the noise; the others to no segment. O(n log n).
PointDistances assign_points(const InitialTree& tree, FitSamples& samples, std::span<const float> spacing,
                             const Context& ctx, const Tolerance& tolerance = {});

/// Removes terminal branches with points that the rest of the tree explains about as well: bark, crotches,
/// and the second of two axes in one branch. Their points are assigned to the segments that explain them.
/// Returns the number of removed branches.
std::uint32_t prune_redundant(InitialTree& tree, FitSamples& samples, std::span<const float> spacing,
                              double noise, const Context& ctx);

/// Builds trees from loose tubes: each is attached by the path from its lowest point to the first existing
/// branch, straight over short gaps, otherwise by a chain of nodes. `standing` contains the roots of existing
/// trees; `add_roots` adds one for every stem base. Paths start there and on measured stems. Returns the
/// number of points reached by paths.
std::uint64_t attach_tubes(InitialTree& tree, FitSamples& samples, const CloudInput& cloud,
                           std::span<const std::uint32_t> standing, bool add_roots, const Context& ctx);

/// Adds branches for the points without a segment: from the point farthest along paths, back along its path
/// to an existing branch. The points about the path are assigned to the branch, so that no other branch
/// starts from them.
void grow_chains(InitialTree& tree, FitSamples& samples, const CloudInput& cloud,
                 const PointDistances& distances, const Context& ctx);

/// Replaces the radius of swellings that are 2.3 times as thick as their supporting branches nearby and at
/// most 12 radii long, caused by a few outliers, by the radius of the supporting branches. O(nodes).
void correct_swollen_radii(InitialTree& tree);

/// Moves the starts of laterals: nodes inside the parent branch are removed, because no points support them,
/// and the axis of the remaining lateral is extrapolated to the axis of the parent branch. O(nodes).
void reattach_laterals(InitialTree& tree, FitSamples& samples, const Context& ctx);

}  // namespace coppice::extract_internal
