#pragma once

#include "coppice/base/fields.h"
#include "coppice/edit/editable_tree.h"
#include "coppice/implicit/solid/solid.h"

namespace coppice {

// Cutting, splitting and spacing nodes. All throw InvalidInput where nothing is selected, or where nothing
// would be left, and change nothing then.

/// Splits the segments that end at the nodes into equal parts; the surface stays as it is. Roots have none.
/// Throws InvalidInput where parts is not in 2 to 1000.
EditChange split(EditableTree& tree, const NodeSet& nodes, int parts = 2);

/// Splits each of these segments once, at `at` in (0, 1) from the parent.
EditChange split_at(EditableTree& tree, const NodeSet& nodes, double at);

/// Makes trees of their own of branches: each takes its first segment along, so that a new root comes at its
/// joint. Roots stay. Throws InvalidInput where there are only roots.
EditChange detach(EditableTree& tree, const NodeSet& nodes);

/// Removes the nodes and all that hangs on them.
EditChange remove_branches(EditableTree& tree, const NodeSet& nodes);

/// Removes the nodes alone: what hangs on them joins their parents, or where they are roots becomes a tree.
EditChange dissolve(EditableTree& tree, const NodeSet& nodes);

/// Spaces the selected nodes evenly: between forks, tips, and nodes that are not selected, segments become as
/// long as `spacing` [m], as nearly as whole numbers of them allow. Nodes that stay keep their ids.
EditChange resample(EditableTree& tree, const NodeSet& nodes, double spacing);

/// What is cut off. A branch is what leaves an axis, with all that hangs on it.
struct PruneOptions {
    float radius = 0;       ///< [m] axes are cut where they are thinner; 0: nowhere
    float length = 0;       ///< [m] branches whose longest way to a tip is shorter go; 0: none
    int order = -1;         ///< branches of a higher order go; -1: none
    float shade = 0;        ///< branches of which every tip lies in more shade go; 0: none
    float shade_share = 0;  ///< branches of which every tip is of this part of all tips, those in most shade
    float shade_cell =
        0;  ///< [m] shade is counted in cubes of this size; 0: a fiftieth of the tree's greatest extent
};

template <class Self, class Visitor>
requires SameOptions<Self, PruneOptions>
constexpr void visit_fields(Self& o, Visitor&& visit) {
    visit(Field{"radius", "axes are cut where they are thinner; 0 = nowhere", Unit::metre, 0, 1e6}, o.radius);
    visit(Field{"length", "branches whose longest way to a tip is shorter go; 0 = none", Unit::metre, 0, 1e6},
          o.length);
    visit(Field{"order", "branches of a higher order go; -1 = none", Unit::none, -1, 1e6}, o.order);
    visit(Field{"shade",
                "branches of which every tip lies in more shade go; five tips right above make 1; 0 = none",
                Unit::none, 0, 1e6},
          o.shade);
    visit(Field{"shade_share",
                "branches of which every tip is of this part of all tips go, those in most shade; 0 = none",
                Unit::none, 0, 1},
          o.shade_share);
    visit(Field{"shade_cell", "size of the cubes that shade is counted in; 0 = a fiftieth of the tree",
                Unit::metre, 0, 1e6},
          o.shade_cell);
}

/// Cuts off what the options say, of the nodes that are selected; roots stay. Each tip shades what lies in a
/// pyramid below it, the less the deeper [Palubicki2009]. O(n).
EditChange prune(EditableTree& tree, const NodeSet& nodes, const PruneOptions& options);

/// Trims a tree to a solid in world space: axes are cut where they leave it, and branches that are nowhere
/// within go; what leads up to it from the root stays. With `keep_inside` false, axes are cut where they
/// enter the solid. Cuts are made at its surface. Throws InvalidInput where nothing would be left but roots.
/// O(n).
EditChange prune_by_solid(EditableTree& tree, const NodeSet& nodes, const Solid& solid,
                          bool keep_inside = true);

/// The shade of each tip: five tips right above make 1. Entries of other nodes are 0. O(n).
Column<StableId, double> shade_of_tips(const EditableTree& tree, double cell);

}  // namespace coppice
