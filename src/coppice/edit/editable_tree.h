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

/// Nodes of a tree, ascending, none twice.
using NodeSet = std::vector<StableId>;

/// What an edit, or taking one back, did to the nodes: all that a surface has to look at again. Which child
/// leads follows from the radii, so the children of a node in `resized`, and the siblings of what is named
/// here, may start with another radius.
struct EditChange {
    NodeSet added;       ///< they were not there before
    NodeSet removed;     ///< they are not there any more
    NodeSet moved;       ///< another position
    NodeSet resized;     ///< another radius
    NodeSet reparented;  ///< another parent, or none, or one where there was none

    bool empty() const;     ///< nothing changed
    NodeSet nodes() const;  ///< all that are named
};

/// A forest that is edited in place: the nodes of a Skeleton, each with a StableId that it keeps until it is
/// removed, whatever happens to the others, and that no other node gets as long as the history reaches back.
///
/// Invariants, between two edits: those of a Skeleton; and no node lies on its parent or on a sibling, unless
/// it did so from the beginning. Children are in order of id, and so nothing depends on the way that led to
/// a state: the same nodes are the same tree, to the bit.
///
/// Edits are made by TreeEdit. Each costs what it touches, O(k log k) for k nodes, whatever the size of the
/// tree, and so does undoing it. 28 bytes a node; each step of the history about 100 bytes, and 5 to 20 for
/// each node that it touched, 4 where it moved with the branch that it is on.
class EditableTree {
  public:
    /// Stable ids are those of the skeleton. Throws InvalidInput where they go up to more than 64 times the
    /// number of nodes and more than a million. O(n).
    explicit EditableTree(const Skeleton& skeleton);

    /// The nodes as a skeleton with their stable ids, parents first, otherwise in order of id; an unedited
    /// tree gives the same bits as the skeleton that it was made of. Throws InvalidInput where no node is
    /// left. O(n), O(n log n) after grafts.
    Skeleton skeleton() const;

    bool contains(StableId n) const { return n.index() < slots() && radius_[n] > 0; }  ///< any id is allowed
    std::uint32_t size() const { return size_; }                                       ///< number of nodes
    std::uint32_t slots() const { return parent_.size(); }  ///< all ids are below; the next new node has this
    StableId parent(StableId n) const { return parent_[n]; }  ///< none for a root
    Vec3 position(StableId n) const { return position_[n]; }  ///< [m] relative to origin(), Z up
    float radius(StableId n) const { return radius_[n]; }     ///< [m] > 0
    Vec3d origin() const { return origin_; }                  ///< [m] see Skeleton

    StableId first_root() const { return first_root_; }                 ///< that of least id; none: no nodes
    StableId first_child(StableId n) const { return first_child_[n]; }  ///< that of least id; none for a tip
    StableId next_sibling(StableId n) const { return next_sibling_[n]; }  ///< by id, among roots too
    bool is_root(StableId n) const { return !parent_[n]; }                ///< whether it has no parent
    bool is_tip(StableId n) const { return !first_child_[n]; }            ///< whether it has no children
    StableId leader(StableId n) const;   ///< the child of greatest radius, of least id on ties
    Segment segment(StableId n) const;   ///< see Skeleton::segment; n must not be a root
    StableId root_of(StableId n) const;  ///< O(depth)
    NodeSet nodes() const;               ///< all of them; O(slots)

    /// Calls visit(n) for a node and all that hangs on it, parents first.
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

    /// The ids of a node and all that hangs on it, parents first.
    std::vector<StableId> subtree(StableId top) const;

    /// From now on notes how edits turn what they move, which places alone do not tell: a branch may roll.
    /// Not kept by undo() and redo().
    void note_turns() { turn_.resize(slots()); }
    /// How far edits have turned the segment that ends at a node, or a root, as they told; none where
    /// turns are not noted.
    Rotation turn(StableId n) const { return n.index() < turn_.size() ? turn_[n.index()] : Rotation{}; }

    std::size_t undo_depth() const { return done_.size(); }       ///< edits that undo() can take back
    std::size_t redo_depth() const { return undone_.size(); }     ///< edits that redo() can make again
    std::size_t history_bytes() const { return history_bytes_; }  ///< of memory, about
    EditChange undo();  ///< takes the last edit back; there must be one
    EditChange redo();  ///< makes the edit again that was taken back last; there must be one
    /// Forgets the oldest edits until the history takes no more than this; the last one stays.
    void limit_history(std::size_t bytes);

  private:
    friend class TreeEdit;

    /// All that a node is; of a node that is not there, the radius is 0.
    struct Node {
        StableId parent;
        Vec3 position;
        float radius = 0;
        friend bool operator==(const Node&, const Node&) = default;
    };
    using Nodes = std::vector<std::pair<StableId, Node>>;  ///< in order of id
    /// The nodes that were moved by motions.
    struct Moves;
    /// The difference of two states: what one has to be combined with to give the other, either way.
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
    std::vector<Rotation> turn_;  ///< by slot; empty where turns are not noted
};

/// One edit of a tree, all of it or nothing: what is not committed is taken back when the edit ends, so that
/// an error in the middle leaves the tree as it was. The tree shows every change at once. One edit at a time.
///
/// All nodes that are named must be there.
class TreeEdit {
  public:
    explicit TreeEdit(EditableTree& tree);          ///< begins
    ~TreeEdit();                                    ///< takes back, unless committed
    TreeEdit(const TreeEdit&) = delete;             ///< an edit is one
    TreeEdit& operator=(const TreeEdit&) = delete;  ///< an edit is one

    /// A new node; without a parent it is a root. Its id is greater than all before it.
    StableId add(StableId parent, Vec3 position, float radius);
    void remove(StableId tip);             ///< a node without children
    void remove_subtree(StableId n);       ///< the node and all that hangs on it
    void move(StableId n, Vec3 position);  ///< puts the node there, and nothing else
    /// Moves the node and all that hangs on it as one. The history keeps little of that.
    void move_subtree(StableId n, const edit_internal::Motion& motion);
    void set_radius(StableId n, float radius);  ///< of this node
    /// Tells that what ends at the node turns, as rigid branches do, beside moving.
    void turn(StableId n, const Rotation& by);
    /// Hangs the node, with all that hangs on it, on another one, or on none; nothing moves. Throws
    /// InvalidInput where `parent` hangs on n. O(depth).
    void set_parent(StableId n, StableId parent);

    /// Ends the edit and remembers it, unless nothing changed; what had been undone cannot be redone then.
    /// Throws InvalidInput naming the node, and takes all back, where an invariant would break: a position or
    /// radius that is not finite or beyond 1e15 m, a radius below 1e-12 m, nodes that would coincide, no node
    /// left.
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
    std::vector<std::pair<StableId, Rotation>> turns_;  ///< where the tree notes them
    std::unique_ptr<EditableTree::Moves> moves_;        ///< subtrees that moved as one
};

}  // namespace coppice
