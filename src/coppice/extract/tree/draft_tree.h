#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "coppice/base/compressed_rows.h"
#include "coppice/base/kernel/round_cone.h"
#include "coppice/base/vec.h"
#include "coppice/skeleton/skeleton.h"

namespace coppice {

/// A forest of nodes that is still being shaped. Parents precede their children, except where a function says
/// that it does not need that. Its surface is that of a `Skeleton`: cones with rounded ends, and of the
/// segments that leave a node only the thickest starts with the node's radius.
struct DraftTree {
    static constexpr std::uint32_t kNoParent = 0xffffffffu;  ///< the parent of a root
    std::vector<std::uint32_t> parent;                       ///< kNoParent for a root
    std::vector<Vec3d> position;                             ///< [m]
    std::vector<double> radius;                              ///< [m] > 0
    std::vector<std::uint8_t> fixed;  ///< 1 where place and radius were measured, and nothing changes them

    std::uint32_t size() const { return static_cast<std::uint32_t>(parent.size()); }  ///< number of nodes
    /// Appends a node; returns its index.
    std::uint32_t add(std::uint32_t from, Vec3d p, double r, bool is_fixed = false) {
        parent.push_back(from);
        position.push_back(p);
        radius.push_back(r);
        fixed.push_back(is_fixed);
        return size() - 1;
    }
};

/// Children of every node, in order of index, and the child that starts with the node's radius. Works in any
/// order of nodes. O(n).
class DraftLinks {
  public:
    explicit DraftLinks(const DraftTree& tree);  ///< does not keep the tree
    /// Chooses the leaders anew, after radii have changed.
    void update_leaders(const DraftTree& tree);

    /// In order of index.
    std::span<const std::uint32_t> children(std::uint32_t n) const { return children_[n]; }
    std::uint32_t leader(std::uint32_t n) const { return leader_[n]; }  ///< kNoParent for a tip
    bool is_tip(std::uint32_t n) const { return children(n).empty(); }  ///< whether it has no children

  private:
    CompressedRows<std::uint32_t> children_;
    std::vector<std::uint32_t> leader_;
};

/// The segment that ends at n, with the radii of its two nodes; of a root the ball about it.
RoundCone axis_cone(const DraftTree& tree, std::uint32_t n);
/// The same as a part of the surface: only the leader starts with the radius of its parent.
RoundCone surface_cone(const DraftTree& tree, const DraftLinks& links, std::uint32_t n);

/// Makes `end` the root of its tree, by turning the way from it to the root round. The order of nodes is left
/// alone: see `sort_parents_first`.
void reroot(DraftTree& tree, std::uint32_t end);

/// Puts parents before children, roots in order of index and each tree as one run. Nodes with `gone` set are
/// left out; they must not have children that stay. Returns the new index of every old node, or kNoParent.
std::vector<std::uint32_t> sort_parents_first(DraftTree& tree, std::span<const char> gone = {});

/// Parents must precede their children.
Skeleton to_skeleton(const DraftTree& tree, Vec3d origin);
/// The same nodes in the same order.
DraftTree to_draft(const Skeleton& skeleton);

}  // namespace coppice
