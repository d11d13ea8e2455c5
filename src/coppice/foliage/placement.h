#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <span>
#include <string_view>

#include "coppice/base/context.h"
#include "coppice/base/fields.h"
#include "coppice/base/option_fields.h"
#include "coppice/base/vec.h"
#include "coppice/foliage/leaf_shape.h"
#include "coppice/mesh/instances.h"
#include "coppice/skeleton/skeleton.h"

namespace coppice {

/// The arrangements of leaves on a shoot.
enum class LeafArrangement {
    spiral,      ///< one leaf per node, turned by the divergence
    two_ranked,  ///< one leaf per node, alternately on both sides, level where the shoot allows: beech
    opposite,    ///< pairs, each turned by a right angle to the last one: maple
    whorled,     ///< several leaves per node, in the gaps of the last node
};

template <>
struct EnumNames<LeafArrangement> {
    static constexpr std::array<std::string_view, 4> names{"spiral", "two_ranked", "opposite", "whorled"};
};

/// The seasons of leaves.
enum class Season {
    bud,     ///< leaves that unfold
    young,   ///< leaves of spring, not yet of full size
    summer,  ///< full foliage
    autumn,  ///< coloured leaves, some of which have fallen
    winter,  ///< none, except on evergreens
};

template <>
struct EnumNames<Season> {
    static constexpr std::array<std::string_view, 5> names{"bud", "young", "summer", "autumn", "winter"};
};

/// Rules that place leaves on a skeleton. A shoot is the outer end of an axis.
struct LeafRules {
    LeafArrangement arrangement = LeafArrangement::spiral;  ///< of the leaves on a shoot
    Season season = Season::summer;                         ///< sizes, colours and fallen leaves
    bool evergreen = false;                                 ///< keeps its leaves in winter
    /// [m] maximum radius of shoots; 0: twice the median of all tips; in [0, 1].
    float max_radius = 0;
    float shoot_length = 0.3f;   ///< [m] length of the leafy end of an axis; in [1e-3, 100]
    int min_order = 1;           ///< minimum branch order of shoots; 0 includes stems; in [0, 1000]
    float internode = 0.025f;    ///< [m] mean distance of nodes along a shoot; in [2e-4, 10]
    float clustering = 0;        ///< 1: internodes are far shorter at the tip than at the base; in [0, 1]
    float divergence = 2.3998f;  ///< [rad] of a spiral between one leaf and the next; in [0, 6.2832]
    int whorl = 3;               ///< leaves per node of whorls; in [2, 50]
    float angle = 0.9f;          ///< [rad] of the petiole to the shoot; in [0, 3.1416]
    float light = 0.7f;          ///< share by which leaves turn level, their upper side up; in [0, 1]
    float droop = 0.25f;         ///< [rad] by which leaves hang down; in [-1.6, 1.6]
    float spread = 0.25f;        ///< [rad] standard deviation of all angles; in [0, 1.6]
    float size = 1;              ///< factor of the size of all leaves; in [0.01, 100]
    float size_spread = 0.15f;   ///< maximum relative deviation of sizes; in [0, 0.9]
    float base_size = 0.75f;     ///< size at the base of a shoot relative to that at its tip; in [0.05, 5]
    float density = 1;           ///< share of the leaves that are kept; in [0, 1]
    /// Maximum leaf area index in summer, to which leaves are thinned out at random; 0: no limit; in [0,
    /// 100].
    float max_index = 0;
    float color_spread = 0.12f;  ///< maximum relative deviation of the brightness; in [0, 1]
    std::optional<Vec3d> young_color = std::nullopt;   ///< sRGB in [0, 1]; default: light green
    std::optional<Vec3d> summer_color = std::nullopt;  ///< the same in summer; default: green
    std::optional<Vec3d> autumn_color = std::nullopt;  ///< the same in autumn; default: yellow
    int seed = 0;                                      ///< seed of all random numbers; in [0, 2^31 - 1]
};

/// Lists the members for front ends.
void list_fields(LeafRules& o, FieldList& list);

/// Figures of placed leaves.
struct FoliageReport {
    std::uint64_t leaves = 0;      ///< number of leaves
    std::uint64_t shoots = 0;      ///< number of leafy shoots
    std::uint64_t thick_tips = 0;  ///< tips that have no leaves because they are thicker than max_radius
    std::uint64_t flowers = 0;     ///< number of flowers and catkins
    std::uint64_t fruit = 0;       ///< number of fruit and cones
    /// leaves, and clusters of flowers and fruit, that were removed, as they would pass through wood
    std::uint64_t inside_wood = 0;
    std::uint64_t floating = 0;   ///< leaves and clusters that are not attached to the bark; always 0
    double leaf_area = 0;         ///< [m^2] of one side
    double crown_area = 0;        ///< [m^2] of the convex hulls of the trees' leaves seen from above
    double leaf_area_index = 0;   ///< leaf_area / crown_area
    double mean_inclination = 0;  ///< [rad] mean angle of the upper sides from upwards
};

/// Calls visit(name, value) for every figure, in order.
template <class Visitor>
void visit_figures(const FoliageReport& r, Visitor&& visit) {
    visit("leaves", r.leaves);
    visit("shoots", r.shoots);
    visit("thick_tips", r.thick_tips);
    visit("flowers", r.flowers);
    visit("fruit", r.fruit);
    visit("inside_wood", r.inside_wood);
    visit("floating", r.floating);
    visit("leaf_area", r.leaf_area);
    visit("crown_area", r.crown_area);
    visit("leaf_area_index", r.leaf_area_index);
    visit("mean_inclination", r.mean_inclination);
}

/// The leaves of a skeleton.
struct Foliage {
    Instances instances;   ///< one per leaf, with the origin of the skeleton
    FoliageReport report;  ///< figures
};

/// Places copies of `models`, which are variants of one leaf, on the shoots of a skeleton: a leaf at every
/// tip, and further ones towards the base of the shoot. Every leaf is attached to the bark: at the distance
/// of the radius from the axis of its segment. Leaves that are attached inside of another branch, or enter
/// wood with their midrib, are removed; wood are the segments thicker than shoots or a tenth of the leaf.
///
/// With a maximum index, the same share of all leaves is kept, by which it is reached within 2 % if the tree
/// has many leaves.
///
/// The leaves of an axis depend only on its own nodes, the stable id of its first node, and the seed, and
/// with a maximum index on the share that is kept: edits elsewhere do not change them. The same bits for any
/// number of threads. O(n + leaves log n) for n nodes, about 1 microsecond of CPU time and 50 bytes per leaf.
/// Throws InvalidInput if a number is out of range, if there are no models, or for more than 20 million
/// leaves; Cancelled.
Foliage place_leaves(const Skeleton& skeleton, std::span<const LeafModel> models, const LeafRules& rules = {},
                     const Context& ctx = {});

}  // namespace coppice
