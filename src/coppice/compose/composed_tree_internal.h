#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "coppice/base/id.h"
#include "coppice/compose/branch_frame_internal.h"
#include "coppice/compose/compose.h"
#include "coppice/compose/placed_segments_internal.h"
#include "coppice/skeleton/skeleton.h"

namespace coppice::compose_internal {

/// A branch node, and a child branch relative to its parent branch.
struct Place {
    std::uint32_t node = 0;       ///< the branch node
    std::uint32_t first = 0;      ///< the first node of the existing branch
    Vec3d position;               ///< [m] position of the node
    Vec3d parent_direction;       ///< unit vector; direction in which the parent branch arrives
    Vec3d direction;              ///< unit vector; direction in which the branch leaves
    double radius = 0;            ///< [m] radius of the parent branch at the node
    double first_radius = 0;      ///< [m] radius of the branch at its first node
    double length = 0;            ///< [m] total length of the branch
    double node_length = 0;       ///< [m] total length of all branches of the node
    double thickest_sibling = 0;  ///< [m] maximum first radius of the siblings
    bool leads = false;           ///< whether it is the thickest branch of the node
};

/// A skeleton with replaceable branches. Parents always precede their children.
class ComposedTree {
  public:
    struct Node {
        std::uint32_t parent = 0;  ///< kNoIndex for a root
        Vec3 position;
        float radius = 0;
        std::uint32_t next = 0;   ///< next sibling, or kNoIndex
        std::uint32_t child = 0;  ///< first child, or kNoIndex
        std::uint32_t order = 0;  ///< order of its axis; 0 for the axis of a root
        /// number of orders of the branch that begins here, as in ChildTreeMeasures
        std::uint32_t orders = 0;
        std::uint32_t depth = 0;  ///< nesting depth of inserted branches; 0 for the template
        double length = 0;        ///< [m] total length of the branch that begins here
        bool gone = false;
    };

    ComposedTree(const Skeleton& parent_direction, const ComposeOptions& options);

    std::uint32_t size() const { return static_cast<std::uint32_t>(nodes_.size()); }
    const Node& operator[](std::uint32_t n) const { return nodes_[n]; }
    void children(std::uint32_t n, std::vector<std::uint32_t>& out) const;
    Place place(std::uint32_t node, std::uint32_t first) const;

    /// Removes the branch at a place temporarily, so that another one can be tried there.
    void take_out(const Place& place);
    /// Restores the branch that was removed last.
    void put_back();

    /// Returns whether a child tree at the place of the last removed branch intersects existing branches.
    /// Near the branch node it may overlap the axes that meet there.
    bool crosses(const Place& place, const Skeleton& tree, std::span<const Vec3> positions,
                 std::span<const float> radii);

    /// Inserts the child tree permanently; `length` and `orders` are per node of it. Throws InvalidInput if
    /// the tree gets too large.
    void put_in(const Place& place, const Skeleton& tree, std::span<const double> length,
                std::span<const std::uint32_t> orders, std::span<const Vec3> positions,
                std::span<const float> radii);

    /// Returns the current tree as a skeleton, with the radii that the options select.
    Skeleton skeleton(const ComposeOptions& options) const;

  private:
    std::uint32_t add(Node node);
    void place_segment(std::uint32_t n);
    std::uint32_t leader(std::uint32_t n) const;
    void find_axes_at(const Place& place);

    std::vector<Node> nodes_;
    Vec3d origin_;
    double clearance_;         ///< as in ComposeOptions
    std::uint32_t max_nodes_;  ///< as in ComposeOptions
    PlacedSegments segments_;
    std::vector<std::uint32_t> taken_;  ///< nodes that were removed last
    std::vector<std::uint32_t>
        at_node_;  ///< segments of the axes at a branch node that are near it, ascending
};

}  // namespace coppice::compose_internal
