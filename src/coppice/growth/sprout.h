#pragma once

#include <cstdint>
#include <numbers>
#include <span>

#include "coppice/base/context.h"
#include "coppice/base/fields.h"
#include "coppice/growth/grow.h"
#include "coppice/growth/guard.h"
#include "coppice/skeleton/skeleton.h"

namespace coppice {

/// The rules of growth by seasons.
struct SproutOptions {
    int seasons = 15;         ///< number of times that buds sprout; in [0, 1000]
    float internode = 0.12f;  ///< [m] length of the stem's segments; in [1e-4, 1e3]
    /// Ratio of the lengths of segments of consecutive branch orders; in [0.1, 1].
    float internode_decay = 0.9f;
    int max_internodes = 6;  ///< maximum number of segments per bud and season; in [1, 1000]
    /// [rad] between a branch and its parent axis; in [0, 3.1].
    float branching_angle = std::numbers::pi_v<float> / 4;
    float branching_spread = 0.1f;  ///< [rad] standard deviation of that angle; in [0, 1.5]
    /// [rad] angle around the axis between consecutive nodes; in [-6.3, 6.3].
    float phyllotaxis = 2.3998277f;
    int buds = 1;         ///< number of lateral buds of a node, evenly spaced around it; in [0, 16]
    bool whorls = false;  ///< only the last node of a season's shoot has lateral buds
    float vigour = 2.2f;  ///< number of segments per leaf in full light; in [0, 100]
    /// Share of the leading bud, or axis, relative to one lateral with the same light; in [0, 1].
    float apical_control = 0.5f;
    /// Number of nodes below a living tip with inhibited lateral buds; in [0, 1000].
    int apical_dominance = 2;
    float tip_death = 0;           ///< probability that a tip dies after a season's shoot; in [0, 1]
    float tropism_x = 0;           ///< preferred direction of axes, of any length except 0; in [-1, 1]
    float tropism_y = 0;           ///< see tropism_x
    float tropism_z = 1;           ///< see tropism_x
    float stem_tropism = 0.3f;     ///< weight of that direction for the stem; in [-10, 10]
    float branch_tropism = 0.05f;  ///< the same for all other axes, which hang if it is below 0; in [-10, 10]
    float light_turn = 0.1f;       ///< weight of the direction towards more light; in [0, 10]
    float wobble = 0.06f;          ///< weight of a random direction; in [0, 10]
    float bud_light = 0.25f;       ///< minimum light in which buds sprout; in [0, 1]
    int bud_seasons = 4;           ///< number of seasons after which a lateral bud dies; in [1, 1000]
    float shed_light = 0.2f;       ///< minimum mean light of the leaves of a branch that is not shed; 0: only
                                   ///< branches without leaves are shed; in [0, 1]
    int leaf_seasons = 3;          ///< lifetime of the leaves of a node in seasons; in [1, 1000]
    float shade = 0.03f;           ///< light that the leaves of a node absorb in their cell; in [0, 1]
    float shade_falloff = 0.6f;    ///< ratio between a layer of cells and the layer above; in [0, 1]
    int shade_depth = 6;  ///< number of shaded layers of cells below, and of cells on each side in the lowest
                          ///< one; in [0, 32]
    float shade_cell = 0;       ///< [m] edge of a cell; 0: two internodes; in [0, 1e4]
    int max_nodes = 1'000'000;  ///< maximum number; in [1, 1e8]
    int seed = 0;               ///< seed of all random numbers; in [0, 2^31 - 1]
};

/// Lists the members for front ends.
void list_fields(SproutOptions& o, FieldList& list);

/// Input of sprout().
struct SproutInput {
    std::span<const Root> roots;   ///< at least one; roots without a direction start upwards
    const Guard* guard = nullptr;  ///< solid that every new segment must avoid, or null
    Vec3d origin = {};             ///< [m] of the skeleton
    double max_bytes = 0;          ///< approximate maximum memory for nodes and shade; 0: unlimited
    GrowthWatch watch = {};        ///< called after every season with the current state, or empty
};

/// Trees grown by rules, with statistics.
struct SproutResult {
    Skeleton skeleton;         ///< radii of nodes are a tenth of the internode: see radii.h
    int seasons = 0;           ///< number of seasons in which a node was added
    std::uint32_t shed = 0;    ///< total number of shed nodes
    std::uint32_t barred = 0;  ///< number of shoots that ended at the guard
    bool full = false;         ///< whether max_nodes was reached
};

/// Grows trees by rules, season by season [Palubicki2009]. Every node has leaves for some seasons, which
/// shade a pyramid of cells below them; all trees share the light. The total light of its leaves determines
/// the growth of a tree; it is distributed from the root upwards, and at every node the continuing axis and
/// each lateral get shares by their own light, weighted by apical control [Borchert1984]. A bud makes as many
/// segments as its share, rounded down.
///
/// The first segment of a lateral starts at the branching angle, on the side given by phyllotaxis; from the
/// second one on, and in continuing axes, a segment turns towards the tropism and the light. Buds sprout if
/// there is enough light, beyond the range of apical dominance. A branch with too little mean light on its
/// leaves, or without leaves, is shed at its joint [Takenaka1994]; so are leafless ends of branches. Stems
/// are kept. Segments slide along a guard's surface by at most 60 degrees: a shoot that meets it at a steeper
/// angle ends there.
///
/// Within a season everything depends on the light and the shares at its beginning, so that the order of buds
/// has no influence. Parents precede their children; roots come first. The result is deterministic
/// (bit-identical). Time O(n) per season for n living nodes, plus depth^3 for every node that gets or loses
/// leaves; about 90 bytes per node, and 2 KiB for each 512 cells that were ever shaded.
///
/// Throws InvalidInput if an option is out of range, there is no root, a root is not finite, excluded by the
/// guard or too far from the origin for single precision, or the memory is insufficient; Cancelled.
SproutResult sprout(const SproutInput& input, const SproutOptions& options = {}, const Context& ctx = {});

}  // namespace coppice
