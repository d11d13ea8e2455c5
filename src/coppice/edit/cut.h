#pragma once

#include "coppice/base/fields.h"
#include "coppice/edit/editable_tree.h"
#include "coppice/implicit/solid/solid.h"

namespace coppice {

// Edits that cut, split and respace branches. All throw InvalidInput if the selection is empty or no node
// would remain; the tree is unchanged then.

/// Splits the segments that end at the nodes into equal parts; the surface is unchanged. Roots are ignored.
/// Throws InvalidInput if `parts` is not in [2, 1000].
EditChange split(EditableTree& tree, const NodeSet& nodes, int parts = 2);

/// Splits each of these segments once, at the parameter `at` in (0, 1) from the parent.
EditChange split_at(EditableTree& tree, const NodeSet& nodes, double at);

/// Detaches branches as separate trees: each keeps its first segment, and a new root is created at its joint.
/// Roots are ignored. Throws InvalidInput if only roots are selected.
EditChange detach(EditableTree& tree, const NodeSet& nodes);

/// Removes the nodes and their descendants.
EditChange remove_branches(EditableTree& tree, const NodeSet& nodes);

/// Removes only the nodes: their children are attached to their parents, or become roots if the node is a
/// root.
EditChange dissolve(EditableTree& tree, const NodeSet& nodes);

/// Spaces the selected nodes evenly: between forks, tips, and nodes that are not selected, segments get the
/// length closest to `spacing` [m] that divides the section evenly. Existing nodes that remain keep their
/// ids.
EditChange resample(EditableTree& tree, const NodeSet& nodes, double spacing);

/// Criteria of prune. A branch is a lateral axis with all its descendants.
struct PruneOptions {
    float radius = 0;  ///< [m] axes are cut where they are thinner; 0: disabled
    float length = 0;  ///< [m] minimum length of the longest path from the base of a branch to a tip; shorter
                       ///< branches are removed; 0: disabled
    int order = -1;    ///< maximum order of branches; -1: disabled
    float shade = 0;   ///< removes branches with more shade than this at every tip; 0: disabled
    /// removes branches with all tips in this most shaded fraction of all tips; 0: disabled
    float shade_share = 0;
    float shade_cell = 0;  ///< [m] edge length of the grid cells in which shade is computed; 0: 1/50 of the
                           ///< maximum extent of the tree
};

/// Lists the members for front ends.
void list_fields(PruneOptions& o, FieldList& list);

/// Removes the branches that meet a criterion, among the selected nodes; roots are kept. Each tip casts shade
/// into a pyramid below it, decreasing with depth [Palubicki2009]. O(n).
EditChange prune(EditableTree& tree, const NodeSet& nodes, const PruneOptions& options);

/// Trims a tree to a solid in world space: axes are cut where they leave it, and branches entirely outside
/// are removed; the path from the root to the solid is kept. With `keep_inside` false, axes are cut where
/// they enter the solid. Cuts are on the surface of the solid. Throws InvalidInput if only roots would
/// remain. O(n).
EditChange prune_by_solid(EditableTree& tree, const NodeSet& nodes, const Solid& solid,
                          bool keep_inside = true);

/// Returns the shade of each tip; five tips directly above make 1. Entries of other nodes are 0. O(n).
Column<StableId, double> shade_of_tips(const EditableTree& tree, double cell);

}  // namespace coppice
