#pragma once

#include <array>
#include <span>
#include <string_view>

#include "coppice/base/context.h"
#include "coppice/base/fields.h"
#include "coppice/edit/editable_tree.h"

namespace coppice {

// Edits that add and join branches. A joined branch is attached to a node of its parent branch: an existing
// one within a fifth of the radius, otherwise a new one that splits the segment, which leaves the surface
// unchanged. If a function throws, the tree is unchanged.

/// Options of draw.
struct DrawOptions {
    double radius = 0;  ///< [m] at its first node; 0: half the radius of the parent branch, or 1/50 of its
                        ///< length if alone
    double tip_radius = 0;  ///< [m] at its last node; 0: a quarter of the first radius
    /// [radius] maximum distance of the first point from an axis, in radii of the branch there
    double snap = 3;
    bool alone = false;  ///< creates a separate tree; the first point is not snapped
};

/// Draws a branch through points [m, world], the first of which snaps to the closest axis. Its radii do not
/// exceed the radius of its parent branch. Throws InvalidInput if there are fewer than two points, or if no
/// axis is near enough, naming the closest one. O(n).
EditChange draw(EditableTree& tree, std::span<const Vec3d> points, const DrawOptions& options = {});

/// Adds a child to a node at an offset [m]; radius [m] 0: the radius of the node.
EditChange append(EditableTree& tree, StableId parent_node, Vec3d by, double radius = 0);

/// Options of graft.
struct GraftOptions {
    double along = 1;  ///< position on the segment that ends at the parent node, 1 = at this node; in [0, 1]
    bool align = false;  ///< rotates the branch so that its azimuth and inclination relative to the parent
                         ///< branch are preserved
    bool limit_radius = true;  ///< limits radii to the radius of the parent branch there
};

/// Moves a branch to another parent branch, with its first segment, ids and shape: its joint moves to the
/// parent node. If `branch` is a root, its children are grafted and the root is removed: this reattaches
/// detached branches. Throws InvalidInput if the parent node is a descendant of the branch, and for a tree of
/// a single node.
EditChange graft(EditableTree& tree, StableId branch, StableId parent_node, const GraftOptions& options = {});

/// The same for a separate skeleton with its root at the parent node: it gets new ids. The reference
/// direction for alignment at its root is +z. Also throws InvalidInput if it is not a single tree with at
/// least one segment.
EditChange graft(EditableTree& tree, const Skeleton& branch, StableId parent_node,
                 const GraftOptions& options = {});

/// Treatment of branches that intersect others.
enum class Crossings {
    keep,  ///< unchanged; the surface options determine the result
    join,  ///< the outgoing portion is attached to the branch that it leaves, and the incoming portion ends
           ///< there
};

template <>
struct EnumNames<Crossings> {
    static constexpr std::array<std::string_view, 2> names{"keep", "join"};
};

/// Joins trees with roots inside branches of other trees: the segment of the parent branch is split at the
/// closest point, and the tree is attached there with radii limited to that of the parent branch. If several
/// branches contain the root, it is attached to the one in which it is deepest; a tree is never attached to
/// itself. Only selected roots are joined. Joined roots are in `reparented`, or in `removed` if the root was
/// on the axis itself.
///
/// Crossings::join processes the selected nodes and their descendants: where an axis enters another branch
/// and leaves it again, the thinner of the two is cut, or the descendant if one is a descendant of the other.
/// The outer portion is attached to the other branch at the closest point; the inner portion is kept and ends
/// inside the branch. If an axis begins or ends inside the branch, it is not cut, so that branches may run
/// inside their parent branch for any length. Skeletons have no loops: to let the surface close loops, use
/// Crossings::keep and merge overlaps.
///
/// O(n log n), plus the number of overlaps. Throws InvalidInput if no root is selected and crossings are
/// kept.
EditChange attach(EditableTree& tree, const NodeSet& nodes, Crossings crossings = Crossings::keep,
                  const Context& ctx = {});

}  // namespace coppice
