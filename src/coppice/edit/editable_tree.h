#pragma once

#include <cstdint>
#include <deque>
#include <memory>
#include <utility>
#include <vector>

#include "coppice/base/rotation.h"
#include "coppice/skeleton/skeleton.h"

namespace coppice {

namespace edit_internal {
struct Motion;
}

/// Set of nodes of a tree: ascending, without duplicates.
using NodeSet = std::vector<StableId>;

/// Nodes changed by an edit, or by undoing one: all that a surface has to update. The leader among siblings
/// depends on the radii, so the children of a node in `resized`, and the siblings of nodes listed here, may
/// start with another radius.
struct EditChange {
    NodeSet added;       ///< new nodes
    NodeSet removed;     ///< nodes that no longer exist
    NodeSet moved;       ///< position changed
    NodeSet resized;     ///< radius changed
    NodeSet reparented;  ///< parent changed, was removed or was set

    bool empty() const;     ///< whether no node changed
    NodeSet nodes() const;  ///< all changed nodes
};

/// A forest that is edited in place: the nodes of a Skeleton, each with a StableId that it keeps until it is
/// removed. An id is not reused as long as the history refers to it.
///
/// Invariants between two edits: those of a Skeleton; and no node coincides with its parent or a sibling,
/// unless it did so from the beginning. Children are in order of id, so that the state does not depend on the
/// edits that led to it: the same nodes form a bit-identical tree.
///
/// Edits are made by TreeEdit. An edit of k nodes costs O(k log k), independent of the size of the tree, and
/// so does undoing it. Memory: 28 bytes per node; about 100 bytes per history entry, plus 5 to 20 bytes per
/// changed node, or 4 bytes if the node moved with its branch.
class EditableTree {
  public:
    /// Keeps the stable ids of the skeleton. Throws InvalidInput if the largest id exceeds both one million
    /// and 64 times the number of nodes. O(n).
    explicit EditableTree(const Skeleton& skeleton);

    /// Returns the nodes as a skeleton with their stable ids, parents first, otherwise in order of id; for an
    /// unedited tree, the result is bit-identical to the original skeleton. Throws InvalidInput if no node is
    /// left. O(n), O(n log n) after grafts.
    Skeleton skeleton() const;

    bool contains(StableId n) const { return n.index() < slots() && radius_[n] > 0; }  ///< any id is allowed
    std::uint32_t size() const { return size_; }                                       ///< number of nodes
    std::uint32_t slots() const {
        return parent_.size();
    }  ///< upper bound of all ids; the id of the next new node
    StableId parent(StableId n) const { return parent_[n]; }  ///< none for a root
    Vec3 position(StableId n) const { return position_[n]; }  ///< [m] relative to origin(), Z up
    float radius(StableId n) const { return radius_[n]; }     ///< [m] > 0
    Vec3d origin() const { return origin_; }                  ///< [m] as in Skeleton

    StableId first_root() const {
        return first_root_;
    }  ///< the root with the smallest id; none if there are no nodes
    StableId first_child(StableId n) const {
        return first_child_[n];
    }  ///< the child with the smallest id; none for a tip
    StableId next_sibling(StableId n) const { return next_sibling_[n]; }  ///< in order of id; also for roots
    bool is_root(StableId n) const { return !parent_[n]; }                ///< whether it has no parent
    bool is_tip(StableId n) const { return !first_child_[n]; }            ///< whether it has no children
    StableId leader(StableId n) const;  ///< the child with the largest radius; on ties, with the smallest id
    Segment segment(StableId n) const;  ///< as Skeleton::segment; n must not be a root
    StableId find_root(StableId n) const;  ///< O(depth)
    NodeSet nodes() const;                 ///< all of them; O(slots)

    /// Calls visit(n) for a node and its descendants, parents first.
    template <class Visit>
    void visit_subtree(StableId top, const Visit& visit) const {
        for (StableId n = top;;) {
            visit(n);
            if (first_child_[n]) {
                n = first_child_[n];
                continue;
            }
            while (n != top && !next_sibling_[n]) n = parent_[n];
            if (n == top) return;
            n = next_sibling_[n];
        }
    }

    /// Returns the ids of a node and its descendants, parents first.
    std::vector<StableId> subtree(StableId top) const;

    /// Starts recording the rotations of edits, which positions alone do not determine because a branch may
    /// roll. Not maintained by undo() and redo().
    void note_turns() { turn_.resize(slots()); }
    /// Returns the accumulated rotation of the segment that ends at a node, or of a root; the identity if
    /// rotations are not recorded.
    Rotation turn(StableId n) const { return n.index() < turn_.size() ? turn_[n.index()] : Rotation{}; }

    std::size_t undo_depth() const { return done_.size(); }       ///< number of edits that can be undone
    std::size_t redo_depth() const { return undone_.size(); }     ///< number of edits that can be redone
    std::size_t history_bytes() const { return history_bytes_; }  ///< approximate memory of the history
    EditChange undo();  ///< undoes the last edit; requires undo_depth() > 0
    EditChange redo();  ///< redoes the last undone edit; requires redo_depth() > 0
    /// Discards the oldest edits until the history uses at most this memory; the last edit is always kept.
    void limit_history(std::size_t bytes);

  private:
    friend class TreeEdit;

    /// Complete state of a node; the radius of a node that does not exist is 0.
    struct Node {
        StableId parent;
        Vec3 position;
        float radius = 0;
        friend bool operator==(const Node&, const Node&) = default;
    };
    using Nodes = std::vector<std::pair<StableId, Node>>;  ///< in order of id
    /// Nodes that were moved by motions.
    struct Moves;
    /// Reversible difference of two states.
    struct Delta {
        std::vector<std::uint8_t> bytes;
        std::uint32_t slots_before = 0, slots_after = 0;
    };

    Node node(StableId n) const { return {parent_[n], position_[n], radius_[n]}; }
    void assign(const Nodes& nodes);
    void resize(std::uint32_t slots);
    void link(StableId n);
    void unlink(StableId n);
    StableId& link_before(StableId n);
    Delta delta_from(const Nodes& before, std::uint32_t slots_before, Moves moves) const;
    EditChange flip(const Delta& delta, bool forward);
    EditChange change_from(const Nodes& before) const;
    void remember(Delta delta);

    Column<StableId, StableId> parent_, first_child_, next_sibling_;
    Column<StableId, Vec3> position_;
    Column<StableId, float> radius_;
    Vec3d origin_;
    StableId first_root_;
    std::uint32_t size_ = 0;
    std::deque<Delta> done_, undone_;
    std::size_t history_bytes_ = 0;
    std::vector<Rotation> turn_;  ///< by slot; empty if rotations are not recorded
};

/// A transaction on a tree: changes that are not committed are rolled back by the destructor, so that an
/// error leaves the tree unchanged. Changes are visible in the tree at once. At most one edit of a tree at a
/// time.
///
/// All nodes passed as arguments must exist.
class TreeEdit {
  public:
    explicit TreeEdit(EditableTree& tree);          ///< begins the edit
    ~TreeEdit();                                    ///< rolls back, unless committed
    TreeEdit(const TreeEdit&) = delete;             ///< not copyable
    TreeEdit& operator=(const TreeEdit&) = delete;  ///< not copyable

    /// Adds a node; without a parent it is a root. Its id is greater than all existing ids.
    StableId add(StableId parent, Vec3 position, float radius);
    void remove(StableId tip);             ///< removes a node without children
    void remove_subtree(StableId n);       ///< removes the node and its descendants
    void move(StableId n, Vec3 position);  ///< moves only this node
    /// Moves the node and its descendants rigidly. The history stores this compactly.
    void move_subtree(StableId n, const edit_internal::Motion& motion);
    void set_radius(StableId n, float radius);  ///< sets the radius of this node
    /// Records a rotation of the segment that ends at the node, in addition to its displacement.
    void turn(StableId n, const Rotation& by);
    /// Attaches the node with its descendants to another parent, or makes it a root; positions do not change.
    /// Throws InvalidInput if `parent` is a descendant of n. O(depth).
    void set_parent(StableId n, StableId parent);

    /// Ends the edit and adds it to the history, unless nothing changed; undone edits can then no longer be
    /// redone. Throws InvalidInput naming the node, and rolls back, if an invariant would be violated: a
    /// position or radius that is not finite or beyond 1e15 m, a radius below 1e-12 m, coincident nodes, or
    /// no remaining node.
    EditChange commit();

  private:
    void touch(StableId n);
    EditableTree::Nodes before();
    void check(const EditableTree::Nodes& before) const;
    void check_place(StableId n, const EditableTree::Nodes& before) const;

    EditableTree& tree_;
    std::uint32_t slots_before_;
    bool committed_ = false;
    bool sorted_ = true;
    EditableTree::Nodes before_;
    std::vector<std::pair<StableId, Rotation>> turns_;  ///< used if the tree records rotations
    std::unique_ptr<EditableTree::Moves> moves_;        ///< subtrees that moved rigidly
};

}  // namespace coppice
