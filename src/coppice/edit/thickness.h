#pragma once

#include "coppice/edit/editable_tree.h"

namespace coppice {

// Edits of radii. Nodes do not move. All throw InvalidInput if the selection is empty or a radius would not
// be positive; the tree is unchanged then.

/// Sets the radius [m] of the nodes.
EditChange set_radii(EditableTree& tree, const NodeSet& nodes, double radius);

/// Multiplies the radii of the nodes.
EditChange scale_radii(EditableTree& tree, const NodeSet& nodes, double factor);

/// Tapers the axes that begin at the nodes linearly along their length, from their first node to their tip;
/// nodes with a selected ancestor are ignored. A radius [m] of 0 keeps the existing one.
EditChange taper(EditableTree& tree, const NodeSet& nodes, double from, double to);

/// Averages radii along axes, like smooth_radii of skeleton/edit_internal.h: the weights are 1/2 for the node
/// and 1/4 each for its parent and its leader. First nodes of axes and tips are unchanged.
EditChange smooth_radii(EditableTree& tree, const NodeSet& nodes, int passes = 1);

/// Sets the radii on the paths from the nodes to their roots by the pipe model [Shinozaki1964]: r^exponent of
/// each ancestor becomes the sum over its children. O(total length of the paths).
EditChange pipe_radii(EditableTree& tree, const NodeSet& nodes, double exponent = 2);

}  // namespace coppice
