#pragma once

#include <array>
#include <string_view>

#include "coppice/base/fields.h"
#include "coppice/edit/editable_tree.h"

namespace coppice {

// Moving, turning and scaling of branches. Each works on the nodes that are selected and all that hangs on
// them; a branch turns about its joint, the node that it leaves from, which stays. All throw InvalidInput
// where nothing is selected, and change nothing then. O(nodes moved).

/// What a branch is turned about.
enum class TurnAxis {
    given,  ///< a direction in space
    own,    ///< its own direction at the joint: it rolls
    host,   ///< the direction of what it grows from: it goes round that
    side,   ///< across both: it is raised towards the direction of its host
};

template <>
struct EnumNames<TurnAxis> {
    static constexpr std::array<std::string_view, 4> names{"given", "own", "host", "side"};
};

/// How branches turn.
struct TurnOptions {
    double angle = 0;                  ///< [rad] counter-clockwise seen against the axis
    TurnAxis about = TurnAxis::given;  ///< what they turn about
    Vec3d axis{0, 0, 1};               ///< of TurnAxis::given; any length but 0
};

/// Moves branches by a vector [m].
EditChange translate(EditableTree& tree, const NodeSet& nodes, Vec3d by);

/// Turns branches, each about its joint.
EditChange rotate(EditableTree& tree, const NodeSet& nodes, const TurnOptions& options);

/// Scales branches from their joints, with their radii or without. Throws InvalidInput for a factor that is
/// not above 0.
EditChange scale(EditableTree& tree, const NodeSet& nodes, double factor, bool radii = true);

/// Mirrors branches in the planes through their joints across `normal`; with `copy` they stay and mirrored
/// ones come beside them, which hang on the same joints; roots are not copied but refused.
EditChange mirror(EditableTree& tree, const NodeSet& nodes, Vec3d normal, bool copy = false);

}  // namespace coppice
