#pragma once

#include <array>
#include <string_view>

#include "coppice/base/fields.h"
#include "coppice/edit/editable_tree.h"

namespace coppice {

// Edits that move, rotate and scale branches. Each applies to the selected nodes and their descendants; a
// branch rotates about its joint, the parent of its first node, which does not move. All throw InvalidInput
// if the selection is empty; the tree is unchanged then. O(nodes moved).

/// Axis about which a branch is rotated.
enum class TurnAxis {
    given,  ///< a direction in world space
    own,    ///< its own direction at the joint: rolls the branch
    host,   ///< the direction of the parent branch: changes the azimuth
    side,   ///< perpendicular to both: raises the branch towards the direction of its parent branch
};

template <>
struct EnumNames<TurnAxis> {
    static constexpr std::array<std::string_view, 4> names{"given", "own", "host", "side"};
};

/// Options of rotate.
struct TurnOptions {
    double angle = 0;                  ///< [rad] counter-clockwise seen against the axis
    TurnAxis about = TurnAxis::given;  ///< axis of the rotation
    Vec3d axis{0, 0, 1};               ///< for TurnAxis::given; any length except 0
};

/// Translates branches by a vector [m].
EditChange translate(EditableTree& tree, const NodeSet& nodes, Vec3d by);

/// Rotates branches, each about its joint.
EditChange rotate(EditableTree& tree, const NodeSet& nodes, const TurnOptions& options);

/// Scales branches about their joints, with or without their radii. Throws InvalidInput if the factor is not
/// positive.
EditChange scale(EditableTree& tree, const NodeSet& nodes, double factor, bool radii = true);

/// Mirrors branches in the planes through their joints with the given normal. With `copy`, the branches are
/// kept and mirrored copies are added at the same joints; throws InvalidInput if a root is to be copied.
EditChange mirror(EditableTree& tree, const NodeSet& nodes, Vec3d normal, bool copy = false);

}  // namespace coppice
