#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include "coppice/base/compressed_rows.h"
#include "coppice/base/context.h"
#include "coppice/base/disjoint_sets.h"
#include "coppice/measure/capsule_tree.h"
#include "coppice/mesh/mesh.h"
#include "coppice/pipeline/quads/quad_build.h"
#include "coppice/pipeline/repair/tube_rows_internal.h"
#include "coppice/skeleton/segment_cone.h"
#include "coppice/spatial/box_tree.h"

namespace coppice::pipeline_internal {

/// A cut ring: a ring of vertices around a tube at which removed and kept quads meet.
struct CutRing {
    TubeRow gone;  ///< removed row on one side
    TubeRow kept;  ///< kept row on the other side
    bool to_tip;   ///< whether `kept` is on the side of the tip
    Loop ring;     ///< in the direction of the removed quads
    Vec3 center;   ///< [m] mean of the ring
    Vec3 outward;  ///< unit vector along the kept tube
    float radius;  ///< [m] mean distance of the ring from its centre
};

/// Rows that are replaced by one repair patch.
struct RowGroup {
    std::vector<TubeRow> tube_rows;  ///< ascending
    std::vector<CutRing> cut_rings;  ///< cut rings at their ends
};

/// Returns the vertices of all cut rings, ring by ring.
std::vector<std::uint32_t> ring_vertices(const RowGroup& group);

/// Set of rows that are removed, including all further rows that have to be removed with them. The set grows,
/// except by exclude().
class RemovedRows {
  public:
    /// `hidden`: branches without a tube of their own. The arguments must outlive this object.
    RemovedRows(const TubeRows& tube_rows, const QuadMesh& mesh, std::vector<RoundCone> hidden,
                const Context& ctx);

    void mark_removed(TubeRow s);  ///< marks a row as removed, unless it is excluded
    void require(TubeRow s);       ///< marks a row that must not be kept
    /// Returns whether a group contains a row that must not be kept.
    bool needs(const RowGroup& group) const;
    /// Excludes a group that cannot be replaced: its rows are kept, now and in later rounds.
    void exclude(const RowGroup& group);
    /// Marks all rows of some trees as removed, including excluded ones, each tree as one group. `trees`:
    /// their roots, ascending; `root`: per node its root.
    void mark_trees(std::span<const NodeId> trees, std::span<const NodeId> root);
    /// Marks all tubes within this number of radii along the tubes from a row as removed, including excluded
    /// rows, as one group.
    void mark_zone(TubeRow tube_row, float radii);
    /// Marks further rows beyond a cut ring as removed, over this number of radii along the tube, up to the
    /// next branch node.
    void move_on(const CutRing& cut_ring, float radii);
    /// Marks rows in both directions from a row as removed, with the same limits.
    void mark_around(TubeRow tube_row, float radii);
    /// Joins two rows, so that they are in one group once both are removed; returns false if they were joined
    /// before.
    bool join(TubeRow a, TubeRow b) { return together_.join(a, b); }
    TubeRow find_group(TubeRow s) { return together_.find(s); }  ///< representative of the rows joined to it

    /// Marks all further rows that have to be removed: all rows at a branch node, and the rows beyond each
    /// cut ring until the ring is at a suitable position.
    void close();

    bool has_excluded() const { return has_excluded_; }          ///< whether rows are excluded
    bool contains(TubeRow s) const { return gone_[s] != 0; }     ///< whether a row is removed
    std::size_t count() const { return marked_.size(); }         ///< number of removed rows
    std::span<const TubeRow> marked() const { return marked_; }  ///< removed rows, unordered
    /// Returns the removed rows in groups that are connected or were joined, ordered by their smallest row.
    std::vector<RowGroup> groups();

  private:
    void mark_along(TubeRow at, bool to_tip, float way);
    void mark_tube(NodeId tube, TubeRow group);
    void close_branch_node(NodeId n);
    bool is_valid_cut(const CutRing& cut_ring) const;
    std::optional<std::array<TubeRow, 2>> adjacent_cut_ring(TubeRow gone, bool to_tip) const;
    CutRing cut_ring_between(TubeRow lower, TubeRow upper) const;

    const TubeRows& tube_rows_;
    const QuadMesh& mesh_;
    CapsuleTree capsules_;
    std::vector<RoundCone> hidden_;
    BoxTree near_hidden_;                                 // boxes around these
    std::vector<std::uint8_t> gone_, excluded_, needed_;  // per row
    DisjointSets together_;
    std::vector<TubeRow> marked_;  // removed rows
    std::size_t closed_ = 0;       // the first ones, for which all neighbours have been checked
    bool has_excluded_ = false;
};

/// The part of the field's skeleton that is wrapped by a group of rows, with a margin beyond its cut rings.
struct PatchSkeleton {
    /// A segment of the field's skeleton, cut at cut rings.
    struct Cut {
        NodeId segment;
        std::uint32_t first;  ///< node of its first section
        std::uint32_t count;  ///< number of sections, with consecutive nodes
    };
    std::vector<Cut> cuts;             ///< by segment
    std::vector<float> until;          ///< per node: parameter of the segment at which its section ends
    Skeleton skeleton;                 ///< a forest
    std::vector<TubeRow> tube_row;     ///< per node: a row that wraps its segment, or none
    std::vector<std::uint8_t> margin;  ///< per node: whether its segment is beyond the cut rings

    /// Returns the node of the section that contains the point with parameter t of a segment; none where the
    /// segment is not included.
    NodeId node_at(NodeId segment, float t) const;
};

/// Finds the segments that are wrapped by groups of rows.
class PatchSkeletons {
  public:
    /// The arguments must outlive this object. O(n).
    PatchSkeletons(const QuadBuild& build, const TubeRows& tube_rows);

    /// Returns the skeleton with segments cut at the cut rings: with a margin that contains at least `count`
    /// segments, if the bodies of the group have that many. O(number of segments).
    PatchSkeleton of(const RowGroup& group, std::size_t count) const;
    /// Returns the segments that a group requires, ascending, with a smaller margin than of(), so that a
    /// previous result remains usable after the group has grown slightly. O(size of the group).
    std::vector<NodeId> needed(const RowGroup& group) const;

  private:
    std::vector<NodeId> segments_near(const RowGroup& group, float margin, std::size_t count) const;

    const QuadBuild& build_;
    const TubeRows& tube_rows_;
    CompressedRows<std::uint32_t> wrapped_;  // per tube: the nodes of the segments that it wraps
};

}  // namespace coppice::pipeline_internal
