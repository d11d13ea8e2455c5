#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <string_view>
#include <vector>

#include "coppice/base/context.h"
#include "coppice/base/fields.h"
#include "coppice/growth/guard.h"
#include "coppice/growth/watch.h"
#include "coppice/skeleton/skeleton.h"

namespace coppice {

/// Options of the growth towards attractors.
struct GrowOptions {
    float influence_radius = 1;  ///< [m] distance within which attractors pull nodes; >= kill_radius
    float kill_radius = 0.2f;    ///< [m] distance from a node within which an attractor is spent; >= step
    float step = 0.1f;           ///< [m] length of every new segment; in [1e-6, 1e4]
    float tropism_x = 0;         ///< preferred direction of branches, of any length except 0; in [-1, 1]
    float tropism_y = 0;         ///< see tropism_x
    float tropism_z = 1;         ///< see tropism_x
    /// Of that direction relative to the pull of the attractors; 0 = off; in [0, 10].
    float tropism_weight = 0;
    float jitter = 0;             ///< weight of a random direction relative to the pull; in [0, 10]
    float min_spacing = 0.3f;     ///< [step] minimum distance between nodes; in [0.01, 0.9]
    float max_turn = 3.1415927f;  ///< [rad] maximum angle between consecutive segments; in [0.05, 3.15]
    int max_children = 0;         ///< maximum number of children of a node; 0 = unlimited; in [0, 1000]
    int bud_interval = 1;  ///< laterals start only at every bud_interval-th node of an axis; in [1, 10000]
    bool trunk = true;     ///< roots out of reach of every attractor first grow towards the nearest one
    int max_nodes = 10'000'000;    ///< maximum number; StopReason::node_limit; in [1, 1e8]
    int max_iterations = 100'000;  ///< maximum number; StopReason::iteration_limit; in [0, 1e9]
    int seed = 0;                  ///< of the jitter; in [0, 2^31 - 1]
};

/// Lists the members for front ends.
void list_fields(GrowOptions& o, FieldList& list);

/// The start of a tree.
struct Root {
    Vec3 position;   ///< [m]
    Vec3 direction;  ///< direction in which the trunk starts, to which max_turn applies; any length; 0 = any
                     ///< direction
};

/// Input of grow().
struct GrowInput {
    std::span<const Vec3> attractors;  ///< [m] marker points, in any order
    std::span<const Root> roots;   ///< several roots compete for the attractors; at least one without `tree`
    const Guard* guard = nullptr;  ///< solid that every new segment must avoid, or null
    Vec3d origin = {};             ///< [m] of the skeleton; with `tree` the origin of the tree is used
    /// Existing tree that continues to grow, or null: new nodes start from its nodes.
    const Skeleton* tree = nullptr;
    GrowthWatch watch = {};  ///< called after every iteration with the current state, or empty
};

/// Reason why growth ended: all attractors are spent, the remaining ones are unreachable, or a limit.
enum class StopReason { attractors_spent, no_progress, node_limit, iteration_limit };

template <>
struct EnumNames<StopReason> {
    static constexpr std::array<std::string_view, 4> names{"attractors_spent", "no_progress", "node_limit",
                                                           "iteration_limit"};
};

/// A grown tree with statistics.
struct GrowResult {
    Skeleton skeleton;  ///< radii of new nodes are a tenth of the step: see radii.h
    StopReason stop = StopReason::attractors_spent;  ///< reason why it ended
    int iterations = 0;                              ///< number of iterations
    std::uint32_t stalls = 0;   ///< number of times that a node grew to a single attractor, because it was
                                ///< blocked on the path to all
    std::uint32_t dropped = 0;  ///< number of times that a node lost an unreachable attractor
    std::vector<std::uint32_t> unreached;  ///< indices of the attractors that are not spent, sorted
};

/// Grows trees towards marker points by space colonization [Runions2007]: in every iteration each attractor
/// pulls the nearest node, each pulled node gets a child one step along the sum of the unit vectors to its
/// attractors, and attractors near a node are spent.
///
/// It always terminates. A node grows again only after its attractors have changed: otherwise it would create
/// the same child again, as between two attractors that pull it back and forth. It then grows to its nearest
/// attractor only, and gives that attractor up if it cannot approach it because of the guard, the spacing or
/// max_turn. Nodes that were never nearest to an attractor are removed at the end.
///
/// All nodes of an existing tree are kept unchanged, with their indices, radii and stable ids; new nodes
/// start from nodes, not from the middle of segments. If none of its nodes is within reach of the attractors,
/// the one nearest to them grows a trunk (GrowOptions::trunk).
///
/// Nodes are in the order of creation, first the nodes of the existing tree, then the roots. The result does
/// not depend on the number of threads (bit-identical). Time O(m log n) for m nodes and n attractors, plus
/// the reassignments of attractors; about 90 bytes per attractor and 80 per node.
///
/// Throws InvalidInput if an option is out of range, a position is not finite or too far from the origin for
/// steps in single precision, there is neither a root nor a tree, a root is excluded by the guard, or the
/// tree has more nodes than max_nodes; Cancelled.
GrowResult grow(const GrowInput& input, const GrowOptions& options = {}, const Context& ctx = {});

}  // namespace coppice
