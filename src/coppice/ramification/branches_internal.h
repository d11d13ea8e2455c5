#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "coppice/base/id.h"
#include "coppice/base/vec.h"
#include "coppice/skeleton/skeleton.h"

namespace coppice::ramification_internal {

/// Axis of a branch, parametrized by arc length and extrapolated straight beyond its ends. Has at least two
/// points; consecutive points differ.
class Path {
  public:
    Path(std::span<const Vec3d> points, std::span<const double> radii, std::span<const double> arcs)
        : points_(points), radii_(radii), arcs_(arcs) {}

    double length() const { return arcs_.back(); }
    std::uint32_t segment_count() const { return static_cast<std::uint32_t>(points_.size()) - 1; }
    std::uint32_t segment_at(double t) const;
    double arc(std::uint32_t point) const { return arcs_[point]; }
    Vec3d position(double t) const;
    double radius(double t) const;  ///< constant beyond the ends
    /// Returns the direction of the chord from t - within to t + within.
    Vec3d direction(double t, double within) const;

    /// Closest position on a segment to p, and the distance of p outside the cone there.
    struct Near {
        double t = 0, outside = 0;
    };
    Near nearest_in(std::uint32_t segment, Vec3d p) const;
    /// Returns the closest position by a descent over the segments from `segment`, which is updated.
    Near nearest(std::uint32_t& segment, Vec3d p) const;

  private:
    std::span<const Vec3d> points_;
    std::span<const double> radii_, arcs_;
};

struct Branch {
    std::uint32_t first_point = 0, point_count = 0;
    std::uint32_t parent = kNoIndex;  ///< parent branch
    double joint = 0;                 ///< arc length on the parent branch
};

/// Skeleton as branches, sorted so that parents precede. At a node a branch continues with the child that is
/// thick and straight on.
class Branches {
  public:
    explicit Branches(const Skeleton& s);

    std::uint32_t count() const { return static_cast<std::uint32_t>(branches_.size()); }
    const Branch& operator[](std::uint32_t b) const { return branches_[b]; }
    Path path(std::uint32_t b) const {
        const Branch& at = branches_[b];
        return {std::span(points_).subspan(at.first_point, at.point_count),
                std::span(radii_).subspan(at.first_point, at.point_count),
                std::span(arcs_).subspan(at.first_point, at.point_count)};
    }
    /// Returns the node at the end of a segment of a branch.
    NodeId find_node(std::uint32_t b, std::uint32_t segment) const {
        return nodes_[branches_[b].first_point + segment + 1];
    }
    /// Returns the node of the segment that contains a position of a branch.
    NodeId node_at(std::uint32_t b, double t) const { return find_node(b, path(b).segment_at(t)); }
    /// Returns the laterals of a branch, in order.
    std::span<const std::uint32_t> laterals(std::uint32_t b) const {
        return std::span(lateral_).subspan(first_lateral_[b], first_lateral_[b + 1] - first_lateral_[b]);
    }
    /// Returns the first node of a branch: a root, or the first node after that of the parent branch.
    NodeId head(std::uint32_t b) const { return head_[b]; }

  private:
    void add_point(Vec3d p, double r, NodeId node);
    void add_branch(const Skeleton& s, NodeId head, std::span<const NodeId> next);

    std::vector<Branch> branches_;
    std::vector<NodeId> head_;
    std::vector<Vec3d> points_;
    std::vector<double> radii_, arcs_;
    std::vector<NodeId> nodes_;             ///< per point: the node at the end of its segment
    std::vector<std::uint32_t> branch_of_;  ///< per node of the skeleton
    std::vector<double> arc_of_;            ///< per node of the skeleton, along its branch
    std::vector<std::uint32_t> first_lateral_, lateral_;
};

}  // namespace coppice::ramification_internal
