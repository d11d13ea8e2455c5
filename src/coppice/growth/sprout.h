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

/// The rules by which a tree grows.
struct SproutOptions {
    int seasons = 15;              ///< times that buds sprout; in [0, 1000]
    float internode = 0.12f;       ///< [m] length of the stem's segments; in [1e-4, 1e3]
    float internode_decay = 0.9f;  ///< length of segments, of an order of branching over the one before; in
                                   ///< [0.1, 1]
    int max_internodes = 6;        ///< segments that a bud makes in a season; in [1, 1000]
    float branching_angle =
        std::numbers::pi_v<float> / 4;  ///< [rad] of a branch to what it leaves; in [0, 3.1]
    float branching_spread = 0.1f;      ///< [rad] standard deviation of that; in [0, 1.5]
    float phyllotaxis = 2.3998277f;     ///< [rad] from node to node about an axis; in [-6.3, 6.3]
    int buds = 1;                       ///< lateral ones of a node, evenly about it; in [0, 16]
    bool whorls = false;                ///< only the last node of a season's shoot has lateral buds
    float vigour = 2.2f;                ///< segments for each leaf in full light; in [0, 100]
    float apical_control = 0.5f;        ///< share of the leading bud, or axis, against one lateral of as much
                                        ///< light; in [0, 1]
    int apical_dominance = 2;           ///< nodes below a living tip whose lateral buds wait; in [0, 1000]
    float tip_death = 0;                ///< chance of a tip to end with a season's shoot; in [0, 1]
    float tropism_x = 0;                ///< direction that axes tend to, of any length but 0; in [-1, 1]
    float tropism_y = 0;                ///< see tropism_x
    float tropism_z = 1;                ///< see tropism_x
    float stem_tropism = 0.3f;          ///< of that direction against straight on, for the stem; in [-10, 10]
    float branch_tropism = 0.05f;       ///< the same for all other axes; below 0 they hang; in [-10, 10]
    float light_turn = 0.1f;            ///< weight of where there is more light; in [0, 10]
    float wobble = 0.06f;               ///< weight of a random direction; in [0, 10]
    float bud_light = 0.25f;            ///< buds in less light than this do not sprout; in [0, 1]
    int bud_seasons = 4;                ///< seasons after which a lateral bud is dead; in [1, 1000]
    float shed_light = 0.2f;            ///< branches whose leaves get less light on average are shed; 0: only
                                        ///< those without leaves; in [0, 1]
    int leaf_seasons = 3;               ///< seasons that the leaves of a node live; in [1, 1000]
    float shade = 0.03f;                ///< light that the leaves of a node take in their cell; in [0, 1]
    float shade_falloff = 0.6f;         ///< of that from cell to cell downwards; in [0, 1]
    int shade_depth = 6;                ///< cells downwards, and to each side at the bottom; in [0, 32]
    float shade_cell = 0;               ///< [m] edge of a cell; 0: two internodes; in [0, 1e4]
    int max_nodes = 1'000'000;          ///< where growth stops; in [1, 1e8]
    int seed = 0;                       ///< of all that is random; in [0, 2^31 - 1]
};

template <class Self, class Visitor>
requires SameOptions<Self, SproutOptions>
constexpr void visit_fields(Self& o, Visitor&& visit) {
    visit(common_field("seasons", "Number of seasons in which buds sprout", Unit::none, 0, 1000), o.seasons);
    visit(common_field("internode", "Length of the segments of the stem", Unit::metre, 1e-4, 1e3),
          o.internode);
    visit(Field{"internode_decay", "Length of segments, of an order of branching over the one before",
                Unit::none, 0.1, 1},
          o.internode_decay);
    visit(Field{"max_internodes", "Segments that a bud makes in a season at most", Unit::none, 1, 1000},
          o.max_internodes);
    visit(common_field("branching_angle", "Mean angle between a branch and its parent axis", Unit::radian, 0,
                       3.1),
          o.branching_angle);
    visit(Field{"branching_spread", "Standard deviation of that", Unit::radian, 0, 1.5}, o.branching_spread);
    visit(common_field("phyllotaxis", "Angle about the axis from the buds of one node to those of the next",
                       Unit::radian, -6.3, 6.3),
          o.phyllotaxis);
    visit(common_field("buds", "Number of lateral buds per node, evenly spaced around it", Unit::none, 0, 16),
          o.buds);
    visit(Field{"whorls", "Only the last node of a season's shoot has lateral buds"}, o.whorls);
    visit(Field{"vigour", "Segments that grow for each leaf in full light", Unit::none, 0, 100}, o.vigour);
    visit(common_field("apical_control",
                       "Share of growth that continues straight on, against one lateral with as much light: "
                       "larger values give a straight leader",
                       Unit::none, 0, 1),
          o.apical_control);
    visit(Field{"apical_dominance", "Nodes below a living tip whose lateral buds wait", Unit::none, 0, 1000},
          o.apical_dominance);
    visit(Field{"tip_death", "Chance of a tip to end with a season's shoot", Unit::none, 0, 1}, o.tip_death);
    visit(Field{"tropism_x", "Direction that axes tend to", Unit::none, -1, 1}, o.tropism_x);
    visit(Field{"tropism_y", "Direction that axes tend to", Unit::none, -1, 1}, o.tropism_y);
    visit(Field{"tropism_z", "Direction that axes tend to", Unit::none, -1, 1}, o.tropism_z);
    visit(Field{"stem_tropism", "Weight of that direction for the stem", Unit::none, -10, 10},
          o.stem_tropism);
    visit(Field{"branch_tropism", "Weight of that direction for branches; below 0 they hang", Unit::none, -10,
                10},
          o.branch_tropism);
    visit(Field{"light_turn", "Weight of the way to more light", Unit::none, 0, 10}, o.light_turn);
    visit(Field{"wobble", "Weight of a random direction", Unit::none, 0, 10}, o.wobble);
    visit(Field{"bud_light", "Buds in less light than this do not sprout; 1 = full light", Unit::none, 0, 1},
          o.bud_light);
    visit(Field{"bud_seasons", "Seasons after which a lateral bud is dead", Unit::none, 1, 1000},
          o.bud_seasons);
    visit(Field{"shed_light",
                "Branches whose leaves get less light than this on average are shed; 0 = only those without "
                "leaves",
                Unit::none, 0, 1},
          o.shed_light);
    visit(Field{"leaf_seasons", "Seasons that the leaves of a node live", Unit::none, 1, 1000},
          o.leaf_seasons);
    visit(Field{"shade", "Light that the leaves of a node take in their cell", Unit::none, 0, 1}, o.shade);
    visit(Field{"shade_falloff", "Part of that from cell to cell downwards", Unit::none, 0, 1},
          o.shade_falloff);
    visit(Field{"shade_depth", "Cells that are shaded downwards, and to each side at the bottom", Unit::none,
                0, 32},
          o.shade_depth);
    visit(Field{"shade_cell", "Edge of a cell; 0 = two internodes", Unit::metre, 0, 1e4}, o.shade_cell);
    visit(Field{"max_nodes", "Number of nodes at which growth stops", Unit::none, 1, 1e8}, o.max_nodes);
    visit(common_field("seed", "Seed of all random numbers", Unit::none, 0, 2147483647), o.seed);
}

/// Where trees sprout, and what is in their way.
struct SproutInput {
    std::span<const Root> roots;   ///< at least one; those without a direction start upwards
    const Guard* guard = nullptr;  ///< what every new segment must keep clear of, or none
    Vec3d origin = {};             ///< [m] of the skeleton
    double most_bytes = 0;         ///< of memory for nodes and shade, about; 0: any
    GrowthWatch watch = {};        ///< told of what has grown after every season, or none
};

/// Trees that grew by rules, and how it went.
struct SproutResult {
    Skeleton skeleton;         ///< radii of nodes are a tenth of the internode: see radii.h
    int seasons = 0;           ///< in which something grew
    std::uint32_t shed = 0;    ///< nodes that were shed, all told
    std::uint32_t barred = 0;  ///< times that the guard ended a shoot
    bool full = false;         ///< whether max_nodes ended it
};

/// Grows trees by rules, season by season [Palubicki2009]. Every node has leaves for some seasons, which
/// shade a pyramid of cells below them; all trees share the light. What the leaves of a tree get in all is
/// what it has to grow by; it goes from the root up, and at every node what goes on straight and each lateral
/// get shares by the light that they get themselves, weighted by apical control [Borchert1984]. A bud makes
/// as many segments as it got, rounded down.
///
/// A lateral's first segment leaves at the branching angle, to the side that phyllotaxis says; from the
/// second one on, and in all that goes on straight, a segment turns towards the tropism and the light. Buds
/// sprout where there is light enough, beyond the reach of apical dominance. A branch whose leaves get too
/// little light on average, or that has none left, is shed at its joint [Takenaka1994]; so are leafless ends
/// of branches. Stems stay. Along a guard's surface segments slide, but by no more than 60 degrees: a shoot
/// that meets it more squarely ends there.
///
/// Within a season everything is decided by the light and the shares as they were at its beginning, so that
/// no order of buds is favoured. Parents precede their children; roots come first. The same input gives the
/// same bits. Time O(n) a season for n living nodes, with depth^3 for every node that gets or loses leaves;
/// about 90 bytes a node, and 2 KiB for each 512 cells that were ever shaded.
///
/// Throws InvalidInput where an option is out of range, there is no root, one is not finite or lies where the
/// guard bars it or too far off for single precision, or memory would not do; Cancelled.
SproutResult sprout(const SproutInput& input, const SproutOptions& options = {}, const Context& ctx = {});

}  // namespace coppice
