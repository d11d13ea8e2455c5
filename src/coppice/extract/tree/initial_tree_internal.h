#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "coppice/base/compressed_rows.h"
#include "coppice/base/id.h"
#include "coppice/base/kernel/round_cone.h"
#include "coppice/base/vec.h"
#include "coppice/skeleton/skeleton.h"

namespace coppice {

/// Forest of nodes during the extraction. Parents precede their children, except where a function accepts any
/// order. Its surface is that of a `Skeleton`: cones with rounded ends; of the segments that leave a node
/// only the thickest one starts with the radius of the node.
struct InitialTree {
    std::vector<std::uint32_t> parent;  ///< kNoIndex for a root
    std::vector<Vec3d> position;        ///< [m]
    std::vector<double> radius;         ///< [m] > 0
    std::vector<std::uint8_t> fixed;    ///< 1 if position and radius were measured and must not change

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

/// Children of every node, sorted by index, and the child that starts with the radius of the node. Accepts
/// any order of nodes. O(n).
class InitialTreeLinks {
  public:
    explicit InitialTreeLinks(const InitialTree& tree);  ///< does not keep a reference to the tree
    /// Updates the leaders after radii have changed.
    void update_leaders(const InitialTree& tree);

    /// Returns the children of n, sorted by index.
    std::span<const std::uint32_t> children(std::uint32_t n) const { return children_[n]; }
    std::uint32_t leader(std::uint32_t n) const {
        return leader_[n];
    }  ///< child that starts with the radius of n; kNoIndex for a tip
    bool is_tip(std::uint32_t n) const { return children(n).empty(); }  ///< returns whether n has no children

  private:
    CompressedRows<std::uint32_t> children_;
    std::vector<std::uint32_t> leader_;
};

/// Returns the segment that ends at n, with the radii of its two nodes; for a root, the ball about it.
RoundCone axis_cone(const InitialTree& tree, std::uint32_t n);
/// Returns the segment as a portion of the surface: only the leader starts with the radius of its parent.
RoundCone surface_cone(const InitialTree& tree, const InitialTreeLinks& links, std::uint32_t n);

/// Makes `end` the root of its tree by reversing the path from it to the root. Does not change the order of
/// the nodes: see `sort_parents_first`.
void reroot(InitialTree& tree, std::uint32_t end);

/// Sorts parents before children, roots by index and each tree contiguously. Removes nodes with `gone` set;
/// these must not have children that remain. Returns the new index of every old node, or kNoIndex.
std::vector<std::uint32_t> sort_parents_first(InitialTree& tree, std::span<const char> gone = {});

/// Converts a tree to a skeleton. Parents must precede their children.
Skeleton to_skeleton(const InitialTree& tree, Vec3d origin);
/// Converts a skeleton to a tree with the same nodes in the same order.
InitialTree to_initial_tree(const Skeleton& skeleton);

}  // namespace coppice
