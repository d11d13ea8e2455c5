#pragma once

#include "coppice/edit/editable_tree.h"

namespace coppice {

// Changing the course of axes. What hangs on an axis goes with it and keeps its shape. A branch that is
// selected by one of its nodes is changed from the joint that this leaves from to the tip of the axis; of
// nodes that hang on each other the first counts. All throw InvalidInput where nothing is selected, and
// change nothing then. O(nodes moved).

/// Bends axes in the plane of their first segment and `towards`: that segment keeps its direction, and so the
/// tangent at the parent, the last one turns by the angle [rad] towards it, and those between by a share of
/// it that grows with the length. Throws InvalidInput for axes of a single segment.
EditChange bend(EditableTree& tree, const NodeSet& nodes, double angle, Vec3d towards = {0, 0, -1});

/// Turns what hangs on axes about them, by nothing at the joint up to the angle [rad] at the tip.
EditChange twist(EditableTree& tree, const NodeSet& nodes, double angle);

/// Draws axes straight between joint and tip, the way there being `amount` in [0, 1].
EditChange straighten(EditableTree& tree, const NodeSet& nodes, double amount = 1);

/// Smooths the course of the selected nodes: each goes half the way to the middle of its neighbours on the
/// axis, `passes` times. Joints and tips of axes stay.
EditChange smooth(EditableTree& tree, const NodeSet& nodes, int passes = 1);

/// Puts a node to a place [m, world], and its axis follows as rigidly as it can [Sorkine2007], up to `reach`
/// [m] along it on both sides (0: all of it); there and at the joint it stays and keeps its direction. Within
/// reach of the tip the axis ends free.
EditChange move_node(EditableTree& tree, StableId node, Vec3d to, double reach = 0);

}  // namespace coppice
