#pragma once

#include <cstdint>
#include <vector>

#include "coppice/base/vec.h"
#include "coppice/mesh/instances.h"

namespace coppice {

/// Index of the material of leaves, Prototype::material; also that of the stalks of flowers and fruit.
inline constexpr std::uint32_t kLeafMaterial = 0;
/// Index of the material of the twigs of branchlets.
inline constexpr std::uint32_t kTwigMaterial = 1;
/// Index of the material of flowers and catkins.
inline constexpr std::uint32_t kFlowerMaterial = 2;
/// Index of the material of fruit and cones.
inline constexpr std::uint32_t kFruitMaterial = 3;

/// The forms of single flowers and fruit.
enum class OrganForm {
    flower,  ///< whorls of petals around stamens
    berry,   ///< surface of revolution: apple, cherry, olive, haw
    nut,     ///< surface of revolution in a cup: acorn, hazelnut
    burr,    ///< ball with spines: horse chestnut, beech
    samara,  ///< pair of winged nuts: maple
    cone,    ///< scales in a spiral of 137.5 degrees around an axis: cones and catkins
};

/// The arrangements of flowers and fruit in a cluster.
enum class OrganCluster {
    single,  ///< one on its stalk
    umbel,   ///< stalks from the end of the axis
    corymb,  ///< stalks along the axis, the lower ones longer, so that the cluster has a flat top
    raceme,  ///< stalks along the axis, the lower ones longer, so that the cluster is conical
};

/// Shape of a cluster of flowers or fruit; the defaults are those of one berry.
struct OrganShape {
    OrganForm form = OrganForm::berry;            ///< of a single flower or fruit
    OrganCluster cluster = OrganCluster::single;  ///< arrangement
    int count = 1;                                ///< flowers or fruit of a cluster; >= 1
    float length = 0.01f;        ///< [m] of a fruit, a wing or a cone along its axis, of a petal; > 0
    float width = 0.01f;         ///< [m] of a fruit, a wing, a cone or a petal; > 0
    float axis_length = 0;       ///< [m] of the common axis of a cluster; >= 0
    float stalk_length = 0.02f;  ///< [m] of each flower or fruit; >= 0
    float stalk_width = 0.001f;  ///< [m] > 0
    float spread = 0.9f;         ///< [rad] maximum angle between the stalks of a cluster and its axis
    int petals = 5;              ///< of a whorl
    int whorls = 1;              ///< of petals
    float opening = 1.2f;        ///< [rad] between petals, or wings, and the axis
    int stamens = 12;            ///< of a flower
    int scales = 60;             ///< of a cone, or spines of a burr
    float dimple = 0;            ///< depth of the hollow at the stalk of a berry per length; in [0, 0.3]
    Vec3d color{0.7, 0.1, 0.1};  ///< sRGB from 0 to 1 of petals, fruit or scales
    Vec3d other_color{0.7, 0.1, 0.1};     ///< the colours of clusters vary between the two
    Vec3d detail_color{0.85, 0.75, 0.3};  ///< of stamens, cups and calyces
    Vec3d stalk_color{0.4, 0.5, 0.2};     ///< of stalks
};

/// The triangles of a cluster that have one material and one range of colours.
struct OrganPart {
    Prototype prototype;  ///< its mesh; the axis of the cluster extends along +y
    Vec3d color;          ///< sRGB
    Vec3d other_color;    ///< sRGB; colours of copies are between the two
};

/// Makes the parts of a cluster: petals, fruit or scales first, then details, then stalks; parts without
/// triangles are left out. Fruit, cones and stalks are closed surfaces; petals and wings have one side.
/// `material` is that of all parts but stalks. Clusters with different `variant` differ in angles.
/// O(triangles). Throws InvalidInput if a number is out of range.
///
/// Sources: the spiral of scales [Vogel1979]; outlines as in leaves.
std::vector<OrganPart> make_organ(const OrganShape& shape, std::uint32_t material, int variant = 0);

}  // namespace coppice
