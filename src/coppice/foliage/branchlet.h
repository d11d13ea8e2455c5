#pragma once

#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include "coppice/base/context.h"
#include "coppice/base/fields.h"
#include "coppice/foliage/leaf_shape.h"
#include "coppice/foliage/placement.h"
#include "coppice/mesh/instances.h"
#include "coppice/skeleton/skeleton.h"

namespace coppice {

/// Twigs with leaves that continue the branches of a skeleton.
struct BranchletOptions {
    float length = 0;             ///< [m] of the main axis; 0: no branchlets; in [0, 20]
    int laterals = 6;             ///< number of side twigs; in [0, 100]
    float lateral_length = 0.5f;  ///< of the longest side twig per length of the main axis; in [0, 2]
    float lateral_angle = 0.8f;   ///< [rad] between side twigs and the main axis; in [0, 1.6]
    float flatness = 0.3f;  ///< share by which side twigs turn into the level of the main axis; in [0, 1]
    float sag = 0.25f;      ///< [rad] by which the main axis bends down towards its tip; in [-2, 2]
    float radius = 0.002f;  ///< [m] at the base; in [1e-4, 0.1]
    float spacing = 0.15f;  ///< [m] between branchlets along a branch; in [1e-3, 10]
    float angle = 0.85f;    ///< [rad] between branchlets and the branch; in [0, 3.1416]
    float light = 0.4f;     ///< share by which branchlets turn level; in [0, 1]
    float droop = 0;        ///< [rad] by which branchlets hang down; in [-1.6, 1.6]
    float spread = 0.3f;    ///< [rad] standard deviation of all angles; in [0, 1.6]
    /// sRGB in [0, 1] of the twigs; default: brown.
    std::optional<Vec3d> color = std::nullopt;
};

/// sRGB of the twigs of branchlets without a colour.
inline constexpr Vec3d kTwigColor{0.36, 0.3, 0.23};

/// Lists the members for front ends.
void list_fields(BranchletOptions& o, FieldList& list);

/// A twig with its leaves. Both meshes have the frame of Prototype: the twig extends along +y.
struct Branchlet {
    Skeleton axes;                  ///< of the twig, in its frame
    LeafModel twig;                 ///< closed tubes, one for each axis; the area is that of the leaves
    Prototype leaves;               ///< all leaves as one mesh, which is empty in winter
    std::vector<Vec3> upper_sides;  ///< unit vector of each leaf
};

/// Makes `count` branchlets that differ in angles and lengths, with copies of the given leaves. The laterals
/// have the arrangement of the leaves. Throws InvalidInput if a number is out of range, or a branchlet has
/// no length; Cancelled.
std::vector<Branchlet> make_branchlets(const BranchletOptions& options, std::span<const LeafModel> models,
                                       const LeafRules& rules, int count, const Context& ctx = {});

}  // namespace coppice
