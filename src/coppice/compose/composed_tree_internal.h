#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "coppice/compose/branch_frame_internal.h"
#include "coppice/compose/compose.h"
#include "coppice/compose/placed_segments_internal.h"
#include "coppice/skeleton/skeleton.h"

namespace coppice::compose_internal {

/// Where a branch leaves its host, and what it is beside it.
struct Place {
    std::uint32_t node = 0;       ///< the branch node
    std::uint32_t first = 0;      ///< the first node of the branch that stands there
    Vec3d position;               ///< [m] of the node
    Vec3d host;                   ///< unit; the way in which the host's axis arrives
    Vec3d direction;              ///< unit; the way in which the branch leaves
    double radius = 0;            ///< [m] of the host at the node
    double first_radius = 0;      ///< [m] of the branch at its first node
    double length = 0;            ///< [m] of the branch
    double node_length = 0;       ///< [m] of all branches of the node
    double thickest_sibling = 0;  ///< [m] the greatest first radius of the others
    bool leads = false;           ///< whether it is the thickest one
};

/// A skeleton whose branches are replaced; parents keep preceding their children.
class ComposedTree {
  public:
    struct Node {
        std::uint32_t parent = 0;  ///< kNone for a root
        Vec3 position;
        float radius = 0;
        std::uint32_t next = 0;    ///< sibling, or kNone
        std::uint32_t child = 0;   ///< first, or kNone
        std::uint32_t order = 0;   ///< of its axis, 0 for that of a root
        std::uint32_t orders = 0;  ///< as in ChildTreeMeasures, of the branch that begins here
        std::uint32_t depth = 0;   ///< how many branches were put in one into another to come here
        double length = 0;         ///< [m] of the branch that begins here
        bool gone = false;
    };
    static constexpr std::uint32_t kNone = 0xffffffffu;

    ComposedTree(const Skeleton& host, const ComposeOptions& options);

    std::uint32_t size() const { return static_cast<std::uint32_t>(nodes_.size()); }
    const Node& operator[](std::uint32_t n) const { return nodes_[n]; }
    void children(std::uint32_t n, std::vector<std::uint32_t>& out) const;
    Place place(std::uint32_t node, std::uint32_t first) const;

    /// Takes the branch at a place out, so that another one can be tried there.
    void take_out(const Place& place);
    /// The one that was taken out last stands again.
    void put_back();

    /// Whether a child tree laid at the place that was taken out last crosses what stands. Near the node it
    /// may meet the axes that meet there.
    bool crosses(const Place& place, const Skeleton& tree, std::span<const Vec3> positions,
                 std::span<const float> radii);

    /// Puts it there for good; `length` and `orders` per node of it. Throws InvalidInput where the tree gets
    /// too large.
    void put_in(const Place& place, const Skeleton& tree, std::span<const double> length,
                std::span<const std::uint32_t> orders, std::span<const Vec3> positions,
                std::span<const float> radii);

    /// What stands, with the radii that the options ask for.
    Skeleton skeleton(const ComposeOptions& options) const;

  private:
    std::uint32_t add(Node node);
    void place_segment(std::uint32_t n);
    std::uint32_t leader(std::uint32_t n) const;
    void find_axes_at(const Place& place);

    std::vector<Node> nodes_;
    Vec3d origin_;
    double clearance_;          ///< as in ComposeOptions
    std::uint32_t most_nodes_;  ///< as in ComposeOptions
    PlacedSegments segments_;
    std::vector<std::uint32_t> taken_;    ///< nodes that were taken out last
    std::vector<std::uint32_t> at_node_;  ///< segments of the axes at a branch node near it, ascending
};

}  // namespace coppice::compose_internal
