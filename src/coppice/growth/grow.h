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

/// How a tree grows into its attractors.
struct GrowOptions {
    float influence_radius = 1;  ///< [m] attractors pull nodes nearer than this; >= kill_radius
    float kill_radius = 0.2f;    ///< [m] an attractor this near a node is spent; >= step
    float step = 0.1f;           ///< [m] length of every new segment; in [1e-6, 1e4]
    float tropism_x = 0;         ///< direction that branches tend to, of any length but 0; in [-1, 1]
    float tropism_y = 0;         ///< see tropism_x
    float tropism_z = 1;         ///< see tropism_x
    float tropism_weight = 0;  ///< of that direction against the pull of the attractors; 0 = none; in [0, 10]
    float jitter = 0;          ///< weight of a random direction against the pull; in [0, 10]
    float min_spacing = 0.3f;  ///< [step] no node is made nearer to another one than this; in [0.01, 0.9]
    float max_turn =
        3.1415927f;        ///< [rad] greatest angle between a segment and the one before; in [0.05, 3.15]
    int max_children = 0;  ///< buds of a node; 0 = any number; in [0, 1000]
    int bud_interval = 1;  ///< laterals leave only every so many nodes along an axis; in [1, 10000]
    bool trunk = true;     ///< roots out of reach of every attractor first grow towards the nearest
    int max_nodes = 10'000'000;    ///< where it stops with StopReason::node_limit; in [1, 1e8]
    int max_iterations = 100'000;  ///< where it stops with StopReason::iteration_limit; in [0, 1e9]
    int seed = 0;                  ///< of the jitter; in [0, 2^31 - 1]
};

template <class Self, class Visitor>
requires SameOptions<Self, GrowOptions>
constexpr void visit_fields(Self& o, Visitor&& visit) {
    visit(Field{"influence_radius", "Distance within which attractors pull", Unit::metre, 1e-6, 1e6},
          o.influence_radius);
    visit(Field{"kill_radius", "Distance within which attractors are spent", Unit::metre, 1e-6, 1e6},
          o.kill_radius);
    visit(Field{"step", "Length of new segments", Unit::metre, 1e-6, 1e4}, o.step);
    visit(Field{"tropism_x", "Direction that branches tend to", Unit::none, -1, 1}, o.tropism_x);
    visit(Field{"tropism_y", "Direction that branches tend to", Unit::none, -1, 1}, o.tropism_y);
    visit(Field{"tropism_z", "Direction that branches tend to", Unit::none, -1, 1}, o.tropism_z);
    visit(Field{"tropism_weight", "Weight of that direction against the attractors", Unit::none, 0, 10},
          o.tropism_weight);
    visit(Field{"jitter", "Weight of a random direction against the attractors", Unit::none, 0, 10},
          o.jitter);
    visit(Field{"min_spacing", "Least distance of nodes in steps", Unit::none, 0.01, 0.9}, o.min_spacing);
    visit(Field{"max_turn", "Greatest angle between a segment and the one before", Unit::radian, 0.05, 3.15},
          o.max_turn);
    visit(
        Field{"max_children", "Greatest number of segments that leave a node; 0 = any", Unit::none, 0, 1000},
        o.max_children);
    visit(Field{"bud_interval", "Laterals leave only every so many nodes", Unit::none, 1, 10'000},
          o.bud_interval);
    visit(Field{"trunk", "Roots out of reach of the attractors grow towards the nearest"}, o.trunk);
    visit(Field{"max_nodes", "Number of nodes at which growth stops", Unit::none, 1, 1e8}, o.max_nodes);
    visit(Field{"max_iterations", "Number of iterations at which growth stops", Unit::none, 0, 1e9},
          o.max_iterations);
    visit(Field{"seed", "Seed of the random directions", Unit::none, 0, 2147483647}, o.seed);
}

/// Where a tree starts.
struct Root {
    Vec3 position;  ///< [m]
    Vec3
        direction;  ///< the trunk starts this way, and max_turn counts from it; any length; 0 = any direction
};

/// What a tree grows from, towards and around.
struct GrowInput {
    std::span<const Vec3> attractors;  ///< [m] marker points, in any order
    std::span<const Root> roots;       ///< several compete for the attractors; at least one without `tree`
    const Guard* guard = nullptr;      ///< what every new segment must keep clear of, or none
    Vec3d origin = {};                 ///< [m] of the skeleton; with `tree` its origin counts instead
    const Skeleton* tree = nullptr;    ///< what grows on, or none: new nodes spring from its nodes
    GrowthWatch watch = {};            ///< told of what has grown after every iteration, or none
};

/// Why growth ended: all attractors spent, none that could be reached, or a limit.
enum class StopReason { attractors_spent, no_progress, node_limit, iteration_limit };

template <>
struct EnumNames<StopReason> {
    static constexpr std::array<std::string_view, 4> names{"attractors_spent", "no_progress", "node_limit",
                                                           "iteration_limit"};
};

/// A grown tree, and how it went.
struct GrowResult {
    Skeleton skeleton;  ///< radii of new nodes are a tenth of the step: see radii.h
    StopReason stop = StopReason::attractors_spent;  ///< why it ended
    int iterations = 0;                              ///< rounds of growth
    std::uint32_t stalls = 0;   ///< times that a node went for one attractor, as all gave no way on
    std::uint32_t dropped = 0;  ///< times that a node gave an attractor up
    std::vector<std::uint32_t> unreached;  ///< numbers of the attractors that are not spent, rising
};

/// Grows trees into marker points by space colonization [Runions2007]: in every iteration each attractor
/// pulls the nearest node, each node so pulled gets a child one step along the sum of the unit vectors to its
/// attractors, and attractors near a node are spent.
///
/// It always ends. A node grows again only once its attractors have changed: else it would make the same
/// child once more, as between two attractors that pull it back and forth. It then goes for its nearest
/// attractor alone, and gives that up where it cannot come nearer: because of the guard, the spacing or
/// max_turn. Nodes that came nearest to no attractor are left out in the end.
///
/// Of a tree that grows on, all nodes are kept as they are, with their numbers, radii and stable ids; new
/// ones spring from nodes, not from the middle of segments. Where none of its nodes is within reach of the
/// attractors, the nearest to them grows a trunk (GrowOptions::trunk).
///
/// Nodes stand in the order in which they grew, those of the tree first, then roots. The same input gives the
/// same bits, whatever the number of threads. Time O(m log n) for m nodes and n attractors, apart from an
/// attractor's changes of its nearest node; about 90 bytes per attractor and 80 per node.
///
/// Throws InvalidInput where an option is out of range, a position is not finite or too far off for single
/// precision to tell steps apart, there is neither root nor tree, a root is where the guard bars it, or the
/// tree has more nodes than max_nodes; Cancelled.
GrowResult grow(const GrowInput& input, const GrowOptions& options = {}, const Context& ctx = {});

}  // namespace coppice
