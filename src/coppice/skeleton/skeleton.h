#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "coppice/base/box.h"
#include "coppice/base/column.h"
#include "coppice/base/id.h"
#include "coppice/base/vec.h"

namespace coppice {

/// The segment between a node and its parent: a cone with rounded ends, with a radius that is linear from a
/// to b.
struct Segment {
    Vec3 a;          ///< [m] at the parent
    Vec3 b;          ///< [m] at the node
    float radius_a;  ///< [m] > 0
    float radius_b;  ///< [m] > 0
};

/// A forest of nodes with radii: trees, roots, vessels, neurons. Immutable; edits return a new skeleton.
///
/// Invariants, checked by the constructor: at least one node; parents precede their children; positions and
/// radii are finite and radii > 0. Nodes may coincide; `repair` and `resample` handle that.
///
/// A segment joins a node to its parent. Its radius is linear between its ends; where several segments begin
/// at a node, only the leader (the child with the largest radius; the first on ties) begins with the parent's
/// radius, and the others begin with their own.
class Skeleton {
  public:
    /// Creates a skeleton without nodes, to be assigned later. Surfaces and files need at least one node.
    Skeleton() = default;
    /// Takes columns of equal length. Throws InvalidInput with the node that violates an invariant. O(n).
    /// `origin` is added by writers: positions are local, so that georeferenced data keep their accuracy.
    /// `stable_ids` is empty or has a unique one for each node, which makes the constructor O(n log n).
    Skeleton(std::vector<NodeId> parent, std::vector<Vec3> position, std::vector<float> radius,
             Vec3d origin = {}, std::vector<StableId> stable_ids = {});

    std::uint32_t size() const { return parent_.size(); }   ///< number of nodes; ids below it are valid
    NodeId parent(NodeId n) const { return parent_[n]; }    ///< none for a root; parent(n) < n
    Vec3 position(NodeId n) const { return position_[n]; }  ///< [m] relative to origin(), Z up
    float radius(NodeId n) const { return radius_[n]; }     ///< [m] > 0
    std::span<const NodeId> parents() const { return parent_.span(); }    ///< by id; see parent()
    std::span<const Vec3> positions() const { return position_.span(); }  ///< [m] relative to origin(), Z up
    std::span<const float> radii() const { return radius_.span(); }       ///< [m] > 0
    Vec3d origin() const { return origin_; }                              ///< [m]

    /// Identifies the node across edits: its assigned number, by default its index. A NodeId is an index in
    /// this skeleton; a stable id stays with the node when others are inserted or removed, and in JSON files.
    StableId stable_id(NodeId n) const {
        return stable_id_.empty() ? StableId(n.index()) : stable_id_[n.index()];
    }
    std::span<const StableId> stable_ids() const { return stable_id_; }  ///< by id; empty: the indices

    std::span<const NodeId> children(NodeId n) const;            ///< in order of id
    bool is_root(NodeId n) const { return !parent_[n]; }         ///< whether it has no parent
    bool is_tip(NodeId n) const { return children(n).empty(); }  ///< a single node is both root and tip
    NodeId leader(NodeId n) const { return leader_[n]; }         ///< none for a tip

    /// Returns the segment that ends at n; n must not be a root.
    Segment segment(NodeId n) const;

    std::uint32_t tree_count() const { return tree_count_; }  ///< number of roots
    Box3 bounds() const;                                      ///< of the balls around the nodes

  private:
    Column<NodeId, NodeId> parent_;
    Column<NodeId, Vec3> position_;
    Column<NodeId, float> radius_;
    Vec3d origin_;
    std::vector<StableId> stable_id_;         ///< empty: the indices
    std::vector<std::uint32_t> first_child_;  ///< size() + 1 offsets into child_
    std::vector<NodeId> child_;
    Column<NodeId, NodeId> leader_;
    std::uint32_t tree_count_ = 0;
};

/// All ids of a skeleton, in order: for (NodeId n : nodes(s)).
class NodeRange {
  public:
    /// Minimal iterator for range-based for loops.
    class Iterator {
      public:
        explicit Iterator(std::uint32_t i) : i_(i) {}    ///< at the id of this index
        NodeId operator*() const { return NodeId(i_); }  ///< current id
        /// Advances to the next id.
        Iterator& operator++() {
            ++i_;
            return *this;
        }
        friend bool operator==(Iterator, Iterator) = default;  ///< whether both are at the same id

      private:
        std::uint32_t i_;
    };
    explicit NodeRange(std::uint32_t size) : size_(size) {}  ///< the ids below `size`
    Iterator begin() const { return Iterator(0); }           ///< at the first id
    Iterator end() const { return Iterator(size_); }         ///< past the last id

  private:
    std::uint32_t size_;
};

/// Returns the ids of a skeleton, parents before their children.
inline NodeRange nodes(const Skeleton& s) { return NodeRange(s.size()); }

}  // namespace coppice
