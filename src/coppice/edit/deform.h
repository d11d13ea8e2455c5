#pragma once

#include "coppice/edit/editable_tree.h"

namespace coppice {

// Edits that change the course of axes. Branches on an axis follow it and keep their shape. A selected node
// denotes its axis from its joint to the tip; nodes with a selected ancestor are ignored. All throw
// InvalidInput if the selection is empty; the tree is unchanged then. O(nodes moved).

/// Bends axes in the plane of their first segment and `towards`: the first segment keeps its direction, and
/// so the tangent at the parent, the last one turns by the angle [rad] towards it, and the others in
/// proportion to the length. Throws InvalidInput for axes of a single segment.
EditChange bend(EditableTree& tree, const NodeSet& nodes, double angle, Vec3d towards = {0, 0, -1});

/// Rotates the branches on an axis about it, by an angle that increases from 0 at the joint to `angle` [rad]
/// at the tip.
EditChange twist(EditableTree& tree, const NodeSet& nodes, double angle);

/// Straightens axes between joint and tip by the fraction `amount` in [0, 1].
EditChange straighten(EditableTree& tree, const NodeSet& nodes, double amount = 1);

/// Smooths the course of the selected nodes: `passes` times, each node moves half the way to the midpoint of
/// its neighbours on the axis. Joints and tips of axes do not move.
EditChange smooth(EditableTree& tree, const NodeSet& nodes, int passes = 1);

/// Moves a node to a position [m, world]; its axis follows as rigidly as possible [Sorkine2007], up to
/// `reach` [m] along it on both sides (0: the whole axis). The ends of this section and the joint do not move
/// and keep their directions. If the tip is within reach, it is free.
EditChange move_node(EditableTree& tree, StableId node, Vec3d to, double reach = 0);

}  // namespace coppice
