#pragma once

#include "coppice/edit/editable_tree.h"

namespace coppice {

// Radii. Nothing moves. All throw InvalidInput where nothing is selected or a radius would not be above 0,
// and change nothing then.

/// Gives the nodes one radius [m].
EditChange set_radii(EditableTree& tree, const NodeSet& nodes, double radius);

/// Multiplies the radii of the nodes.
EditChange scale_radii(EditableTree& tree, const NodeSet& nodes, double factor);

/// Lets the axes that begin at the nodes taper evenly along their length, from their first node to their tip;
/// of nodes that hang on each other the first counts. A radius [m] of 0 is that which is there.
EditChange taper(EditableTree& tree, const NodeSet& nodes, double from, double to);

/// Averages radii along axes, as smooth_radii of skeleton/edit.h does: each node keeps half of its radius and
/// takes a quarter each of its parent's and its leader's. First nodes of axes and tips stay.
EditChange smooth_radii(EditableTree& tree, const NodeSet& nodes, int passes = 1);

/// Radii by the pipe model [Shinozaki1964] on the ways from the nodes to their roots: r^exponent of each node
/// that one of them hangs on becomes the sum over its children. O(all ways together).
EditChange pipe_radii(EditableTree& tree, const NodeSet& nodes, double exponent = 2);

}  // namespace coppice
