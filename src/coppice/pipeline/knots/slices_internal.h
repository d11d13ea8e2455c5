#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include "coppice/base/compressed_rows.h"
#include "coppice/mesh/control_mesh.h"
#include "coppice/remesh/boundary.h"
#include "coppice/skeleton/skeleton.h"

namespace coppice::pipeline_internal {

/// The tubes that a surface of quads is made of, and the skeleton whose field they wrap.
struct TubeMap {
    const Skeleton& tubes;           ///< a tube is named by its child node, the ball of a lone node by that
    const Skeleton& skeleton;        ///< of the field
    std::span<const NodeId> source;  ///< per node of `tubes`: the node of `skeleton` it stands for
    const CompressedRows<NodeId>&
        wrapping;  ///< per node of `skeleton`: the tubes about its segment, in order
    std::span<const std::array<float, 2>> sides = {};  ///< see Slices
};

/// Number of segments that meet at a node.
inline std::uint32_t degree(const Skeleton& s, NodeId n) {
    return static_cast<std::uint32_t>(s.children(n).size()) + (s.is_root(n) ? 0 : 1);
}

/// Calls visit(segment) for the segments that meet at a node, each named by its child node.
template <class Visit>
void for_each_segment_at(const Skeleton& s, NodeId n, const Visit& visit) {
    if (!s.is_root(n)) visit(n);
    for (const NodeId c : s.children(n)) visit(c);
}

/// A row of refined quads around a tube, numbered tube by tube from its beginning to its end; what closes a
/// tube belongs to its outermost row, and what lies between those at a branch node to that of the tube that
/// ends there, or to the first that begins where none does.
using Slice = std::uint32_t;

/// The refined quads by slice.
class Slices {
  public:
    static constexpr Slice kNone = 0xffffffffu;  ///< no slice

    /// All must outlive this. `sides`: per tube between which parameters of its axis the quads lie, where
    /// they do not along the whole. O(cage).
    Slices(const ControlMesh& cage, const Skeleton& tubes, int levels,
           std::span<const std::array<float, 2>> sides = {});

    std::uint32_t count() const { return tubes_->size() << levels_; }  ///< some have no quads
    std::uint32_t per_tube() const { return 1u << levels_; }
    int levels() const { return levels_; }          ///< times that the cage was refined
    std::uint32_t sides() const { return sides_; }  ///< quads of the cage around a tube
    const ControlMesh& cage() const { return *cage_; }
    const Skeleton& tubes() const { return *tubes_; }

    Slice first(NodeId tube) const { return tube.index() << levels_; }
    Slice last(NodeId tube) const { return first(tube) + per_tube() - 1; }
    NodeId tube(Slice s) const { return NodeId(s >> levels_); }
    std::uint32_t row(Slice s) const { return s & (per_tube() - 1); }

    /// The tube to which a cage quad belongs.
    NodeId tube_of(std::uint32_t cage_quad) const {
        const NodeId n(cage_->region[cage_quad]);
        return cage_->part[cage_quad] == TubePart::fork ? fork_tube(n) : n;
    }
    /// That of a refined quad.
    Slice of_quad(std::uint32_t quad) const;
    /// The node at which a tube ends, which may be one of another branch.
    NodeId end_node(NodeId tube) const { return end_[tube.index()]; }
    /// The node at an end of a tube: 0 where it begins, 1 where it ends.
    NodeId node(NodeId tube, int end) const { return end == 0 ? tubes_->parent(tube) : end_node(tube); }
    /// Which end of a tube lies at one of its two nodes.
    int end_at(NodeId tube, NodeId node) const { return end_node(tube) == node ? 1 : 0; }
    /// Number of tubes that meet at a node.
    std::uint32_t tube_count(NodeId n) const;
    /// Calls visit(tube) for these.
    template <class Visit>
    void for_each_tube_at(NodeId n, const Visit& visit) const {
        if (end_node(n) == n) for_each_segment_at(*tubes_, n, visit);
        for (const NodeId tube : ending_at_[n.index()]) visit(tube);
    }
    /// Whether a node is a branch node: three tubes or more meet there, or such as have quads between them,
    /// or one of another branch.
    bool is_fork(NodeId n) const { return has_fork_[n.index()] != 0; }
    /// The tube to which quads between those at a branch node belong.
    NodeId fork_tube(NodeId n) const { return tubes_->is_root(n) ? tubes_->children(n)[0] : n; }
    /// The slice of a tube at one of its two nodes.
    Slice at(NodeId tube, NodeId node) const { return end_at(tube, node) == 1 ? last(tube) : first(tube); }
    /// The slice at a place of the field's skeleton that a tube wraps.
    Slice near(NodeId tube, Vec3 p) const;

    /// The next slice towards the tip or the root; kNone at branch nodes and ends.
    Slice next(Slice s, bool towards_tip) const;

    /// The refined vertices at which a slice begins, around the tube, as its quads run through them.
    Loop ring(Slice s, std::span<const Quad> quads) const;

  private:
    const ControlMesh* cage_;
    const Skeleton* tubes_;
    int levels_;
    std::span<const std::array<float, 2>> side_;  ///< per tube, or none
    std::vector<std::uint32_t> first_side_;       ///< per tube: its first cage quad that is a side
    CompressedRows<NodeId> ending_at_;            ///< per node: tubes of other branches that end there
    std::vector<NodeId> end_;                     ///< per tube: see end_node
    std::vector<std::uint8_t> has_fork_;          ///< per node: whether it is a branch node
    std::uint32_t sides_ = 0;
};

/// The node at the other end of a segment.
inline NodeId other_end(const Skeleton& s, NodeId segment, NodeId end) {
    return end == segment ? s.parent(segment) : segment;
}

}  // namespace coppice::pipeline_internal
