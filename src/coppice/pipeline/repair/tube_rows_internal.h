#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include "coppice/base/compressed_rows.h"
#include "coppice/base/id.h"
#include "coppice/mesh/control_mesh.h"
#include "coppice/pipeline/remesh/boundary_internal.h"
#include "coppice/skeleton/skeleton.h"

namespace coppice::pipeline_internal {

/// Returns the number of segments that meet at a node.
inline std::uint32_t degree(const Skeleton& s, NodeId n) {
    return static_cast<std::uint32_t>(s.children(n).size()) + (s.is_root(n) ? 0 : 1);
}

/// Calls visit(segment) for the segments that meet at a node, each identified by its child node.
template <class Visit>
void for_each_segment_at(const Skeleton& s, NodeId n, const Visit& visit) {
    if (!s.is_root(n)) visit(n);
    for (const NodeId c : s.children(n)) visit(c);
}

/// A tube row: a row of refined quads around a tube, numbered tube by tube from its beginning to its end. The
/// cap of a tube belongs to its outermost row; the quads between the tubes at a branch node belong to the row
/// of the tube that ends there, or of the first that begins there if no tube ends.
using TubeRow = std::uint32_t;

/// The refined quads by tube row.
class TubeRows {
  public:
    /// The arguments must outlive this object. `sides`: per tube the range of parameters of its axis along
    /// which the quads are, if they do not extend along the whole. O(cage).
    TubeRows(const ControlMesh& cage, const Skeleton& tubes, int levels,
             std::span<const std::array<float, 2>> sides = {});

    std::uint32_t count() const { return tubes_->size() << levels_; }  ///< some rows have no quads
    std::uint32_t per_tube() const { return 1u << levels_; }
    int levels() const { return levels_; }          ///< number of refinements of the cage
    std::uint32_t sides() const { return sides_; }  ///< number of quads of the cage around a tube
    const ControlMesh& cage() const { return *cage_; }
    const Skeleton& tubes() const { return *tubes_; }

    TubeRow first(NodeId tube) const { return tube.index() << levels_; }
    TubeRow last(NodeId tube) const { return first(tube) + per_tube() - 1; }
    NodeId tube(TubeRow s) const { return NodeId(s >> levels_); }
    std::uint32_t row(TubeRow s) const { return s & (per_tube() - 1); }

    /// Returns the tube to which a cage quad belongs.
    NodeId get_tube(std::uint32_t cage_quad) const {
        const NodeId n(cage_->region[cage_quad]);
        return cage_->part[cage_quad] == TubeFace::fork ? fork_tube(n) : n;
    }
    /// Returns the row of a refined quad.
    TubeRow of_quad(std::uint32_t quad) const;
    /// Returns the node at which a tube ends, which may be a node of another branch.
    NodeId end_node(NodeId tube) const { return end_[tube.index()]; }
    /// Returns the node at an end of a tube: 0 for its beginning, 1 for its end.
    NodeId node(NodeId tube, int end) const { return end == 0 ? tubes_->parent(tube) : end_node(tube); }
    /// Returns which end of a tube is at one of its two nodes.
    int end_at(NodeId tube, NodeId node) const { return end_node(tube) == node ? 1 : 0; }
    /// Returns the number of tubes that meet at a node.
    std::uint32_t tube_count(NodeId n) const;
    /// Calls visit(tube) for the tubes that meet at a node.
    template <class Visit>
    void for_each_tube_at(NodeId n, const Visit& visit) const {
        if (end_node(n) == n) for_each_segment_at(*tubes_, n, visit);
        for (const NodeId tube : ending_at_[n.index()]) visit(tube);
    }
    /// Returns whether a node is a branch node: a node at which three or more tubes meet, or tubes with quads
    /// between them, or a tube of another branch.
    bool is_fork(NodeId n) const { return has_fork_[n.index()] != 0; }
    /// Returns the tube to which the quads between the tubes at a branch node belong.
    NodeId fork_tube(NodeId n) const { return tubes_->is_root(n) ? tubes_->children(n)[0] : n; }
    /// Returns the row of a tube at one of its two nodes.
    TubeRow at(NodeId tube, NodeId node) const { return end_at(tube, node) == 1 ? last(tube) : first(tube); }
    /// Returns the row at a position of the field's skeleton that a tube wraps.
    TubeRow near(NodeId tube, Vec3 p) const;

    /// Returns the next row towards the tip or the root; kNoIndex at branch nodes and ends.
    TubeRow next(TubeRow s, bool towards_tip) const;

    /// Returns the refined vertices at which a row begins, around the tube, in the direction of its quads.
    Loop ring(TubeRow s, std::span<const Quad> quads) const;

  private:
    const ControlMesh* cage_;
    const Skeleton* tubes_;
    int levels_;
    std::span<const std::array<float, 2>> side_;  ///< per tube, or empty
    std::vector<std::uint32_t> first_side_;       ///< per tube: its first cage quad that is a side
    CompressedRows<NodeId> ending_at_;            ///< per node: tubes of other branches that end there
    std::vector<NodeId> end_;                     ///< per tube: see end_node
    std::vector<std::uint8_t> has_fork_;          ///< per node: whether it is a branch node
    std::uint32_t sides_ = 0;
};

/// Returns the node at the other end of a segment.
inline NodeId other_end(const Skeleton& s, NodeId segment, NodeId end) {
    return end == segment ? s.parent(segment) : segment;
}

}  // namespace coppice::pipeline_internal
