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
#include "coppice/pipeline/knots/slices_internal.h"

namespace coppice::pipeline_internal {

/// Where quads that go meet quads that stay: a ring of vertices around a tube.
struct Seam {
    Slice gone;    ///< the slice on one side
    Slice kept;    ///< the slice on the other
    bool to_tip;   ///< whether `kept` lies towards the tip
    Loop ring;     ///< as the quads that go run through it
    Vec3 center;   ///< [m] mean of the ring
    Vec3 outward;  ///< along the tube that stays, of length 1
    float radius;  ///< [m] mean distance of the ring from its centre
};

/// Slices that are to be replaced in one piece.
struct KnotGroup {
    std::vector<Slice> slices;  ///< ascending
    std::vector<Seam> seams;    ///< where they end
};

/// The vertices of the rings of all its seams, one ring after the other.
std::vector<std::uint32_t> ring_vertices(const KnotGroup& group);

/// Slices that are to be replaced, together with all that is needed to do so cleanly. They only become more.
class Knots {
  public:
    /// All must outlive this.
    Knots(const TubeMap& map, const Slices& slices, const QuadMesh& mesh, const Context& ctx);

    void take(Slice s);  ///< takes a slice, unless it is spared
    void need(Slice s);  ///< takes a slice that must not stay, whatever that takes
    /// Whether some slice of a group must not stay.
    bool needs(const KnotGroup& group) const;
    /// Gives a group back for which nothing fits: its slices stay, and are spared from now on.
    void spare(const KnotGroup& group);
    /// Takes all of some trees, named by their roots in ascending order, spared or not, each as one group;
    /// `root` is that of every node.
    void take_trees(std::span<const NodeId> trees, std::span<const NodeId> root);
    /// Takes all tubes within so many radii of a slice, along the tubes, spared or not, as one group.
    void take_zone(Slice slice, float radii);
    /// Takes slices on from a seam, so many radii along the tube, as far as the next branch node.
    void move_on(const Seam& seam, float radii);
    /// Takes slices both ways from one on, likewise.
    void take_around(Slice slice, float radii);
    /// Sees to it that two slices, once both are taken, are in one group; false when they were.
    bool join(Slice a, Slice b) { return together_.join(a, b); }
    Slice group_of(Slice s) { return together_.find(s); }  ///< one that stands for all that were joined to it

    /// Takes what else has to go: all that meets at a branch node, and slices on from each seam until that
    /// lies well.
    void close();

    bool spares_any() const { return spares_any_; }          ///< whether some slices are spared
    bool contains(Slice s) const { return gone_[s] != 0; }   ///< whether it goes
    std::size_t count() const { return taken_.size(); }      ///< slices that go
    std::span<const Slice> taken() const { return taken_; }  ///< those that go, in no order
    /// What goes, in pieces: slices that are connected or were joined, by their least.
    std::vector<KnotGroup> groups();

  private:
    void take_along(Slice at, bool to_tip, float way);
    void take_tube(NodeId tube, Slice group);
    void close_branch_node(NodeId n);
    bool lies_well(const Seam& seam) const;
    std::optional<std::array<Slice, 2>> seam_beside(Slice gone, bool to_tip) const;
    Seam seam_between(Slice lower, Slice upper) const;

    TubeMap map_;
    const Slices& slices_;
    const QuadMesh& mesh_;
    CapsuleTree capsules_;
    std::vector<std::uint8_t> gone_, spared_, needed_;  // per slice
    DisjointSets together_;
    std::vector<Slice> taken_;  // those that are gone
    std::size_t closed_ = 0;    // of them, the first so many have nothing beside them that has to go too
    bool spares_any_ = false;
};

/// The part of the field's skeleton that a group of slices had to wrap, and a margin beyond its seams.
struct KnotSkeleton {
    /// A segment of the field's skeleton, cut where seams lie.
    struct Cut {
        NodeId segment;
        std::uint32_t first;  ///< node of its first part
        std::uint32_t count;  ///< of parts, whose nodes follow each other
    };
    std::vector<Cut> cuts;             ///< by segment
    std::vector<float> until;          ///< per node: parameter of the segment where its part ends
    Skeleton skeleton;                 ///< a forest
    std::vector<Slice> slice;          ///< per node: one that wraps its segment, or none
    std::vector<std::uint8_t> margin;  ///< per node: whether its segment lies beyond the seams

    /// The node of the part that holds the point with parameter t of a segment; none where it is not cut.
    NodeId node_at(NodeId segment, float t) const;
};

/// Finds the segments that groups of slices had to wrap.
class KnotSkeletons {
  public:
    /// All must outlive this. O(n).
    KnotSkeletons(const TubeMap& map, const Slices& slices);

    /// With segments cut at the seams; `wide`: for a group that has grown, and may again. O(size of the
    /// group).
    KnotSkeleton of(const KnotGroup& group, bool wide) const;
    /// The segments that a group needs, ascending: less of a margin than of() takes, so that what was made of
    /// that serves it when it has grown a little. O(size of the group).
    std::vector<NodeId> needed(const KnotGroup& group) const;

  private:
    std::vector<NodeId> segments_near(const KnotGroup& group, float margin) const;

    const TubeMap& map_;
    const Slices& slices_;
    CompressedRows<std::uint32_t> wrapped_;  // per tube: the nodes whose segments it wraps
};

}  // namespace coppice::pipeline_internal
