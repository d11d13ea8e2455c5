#pragma once

#include <array>
#include <span>
#include <string_view>

#include "coppice/base/context.h"
#include "coppice/base/fields.h"
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

/// The same of a branch that belongs to no tree yet, by its root, which comes to the host: it gets new ids.
/// What it is aligned with at its root is +z. Throws InvalidInput also where it is not one tree with a
/// segment.
EditChange graft(EditableTree& tree, const Skeleton& branch, StableId host, const GraftOptions& options = {});

/// What becomes of branches that run through others.
enum class Crossings {
    keep,  ///< nothing: the surface says what becomes of them
    join,  ///< what comes out springs from the wood that it came through, and what went in ends there
};

template <>
struct EnumNames<Crossings> {
    static constexpr std::array<std::string_view, 2> names{"keep", "join"};
};

/// Joins trees whose roots lie inside the wood of others: the host's segment is split at the foot point and
/// the tree hangs there, no radius greater than the host's. Where the wood of several holds a root, the one
/// it lies deepest in takes it; no tree comes to hang on itself. Of the roots that are selected. What was
/// joined is in `reparented`, or in `removed` where the root lay on the axis itself.
///
/// Crossings are joined, where that is asked for, of the branches that hang on the selected nodes: where the
/// axis of one enters the wood of another one, and leaves it again, the thinner of the two is cut in two, or
/// the one that hangs on the other. Its outer part comes to hang on the other one at the foot point; its
/// inner part stays and ends within the wood. Where an axis begins or ends in the wood, nothing is cut, so
/// that branches may run in the wood of their hosts for as long as they like. Skeletons have no loops: to
/// let the surface close them, keep crossings and let overlaps merge.
///
/// O(n log n), and as much as there is wood that overlaps. Throws InvalidInput where no root is selected and
/// crossings are kept.
EditChange attach(EditableTree& tree, const NodeSet& nodes, Crossings crossings = Crossings::keep,
                  const Context& ctx = {});

}  // namespace coppice
