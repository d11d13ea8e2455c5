#pragma once

#include <span>

#include "coppice/base/context.h"
#include "coppice/edit/editable_tree.h"

namespace coppice {

// Adding and joining branches. What is joined gets a node of its host to hang on: one that is there, within a
// fifth of the radius, else the host's segment is split, which leaves the surface as it is. Nothing changes
// where they throw.

/// How a branch is drawn.
struct DrawOptions {
    double radius = 0;  ///< [m] at its first node; 0: half that of its host, alone a fiftieth of its length
    double tip_radius = 0;  ///< [m] at its last node; 0: a quarter of the first one's
    double snap = 3;  ///< [radius] its first point has to be this near to an axis, in radii of the wood there
    bool alone = false;  ///< a tree of its own; nothing is snapped
};

/// Draws a branch through points [m, world], the first of which snaps to the nearest axis. Its radii are no
/// greater than its host's. Throws InvalidInput for less than two points, and where no axis is near enough,
/// naming the nearest. O(n).
EditChange draw(EditableTree& tree, std::span<const Vec3d> points, const DrawOptions& options = {});

/// A new node on a node, away from it by a vector [m]; radius [m] 0: that of the node.
EditChange append(EditableTree& tree, StableId host, Vec3d by, double radius = 0);

/// How a branch is grafted.
struct GraftOptions {
    double along = 1;          ///< where on the segment that ends at the host, 1 = at the host; in [0, 1]
    bool align = false;        ///< turns with the host, so that azimuth and inclination to it stay
    bool limit_radius = true;  ///< no radius exceeds that of the host there
};

/// Moves a branch to another host, with its first segment, ids and shape: its joint comes to the host. Of a
/// root, what hangs on it is grafted, and the root goes: that is how detached branches come back. Throws
/// InvalidInput where the host hangs on the branch, and for a tree of a single node.
EditChange graft(EditableTree& tree, StableId branch, StableId host, const GraftOptions& options = {});

/// Joins trees whose roots lie inside the wood of others: the host's segment is split at the foot point and
/// the tree hangs there, no radius greater than the host's. Where the wood of several holds a root, the one
/// it lies deepest in takes it; no tree comes to hang on itself. Of the roots that are selected. What was
/// joined is in `reparented`, or in `removed` where the root lay on the axis itself. O(n log n). Throws
/// InvalidInput where no root is selected.
EditChange attach(EditableTree& tree, const NodeSet& roots, const Context& ctx = {});

}  // namespace coppice
