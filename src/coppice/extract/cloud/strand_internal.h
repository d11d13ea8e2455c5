#pragma once

#include <array>
#include <cstdint>
#include <limits>
#include <span>
#include <vector>

#include "coppice/extract/cloud/graph_internal.h"
#include "coppice/extract/tree/draft_tree.h"

namespace coppice::extract_internal {

/// Follows one branch at a time: a path over the points of its surface becomes a line through its middle.
/// Made once for many branches, so that they share memory.
class Strand {
  public:
    struct Member {
        std::uint32_t point;
        double t;        ///< where on the line it is: index + fraction
        double squared;  ///< [m^2] distance from the line
    };

    /// `node` is that of each point, kNone for free ones.
    Strand(std::span<const Vec3> points, const Graph& graph, std::span<const float> spacing,
           std::span<const std::uint32_t> node, double step);

    /// Takes the path of free points from `start` to the first point that has a node; returns that point.
    /// `start` may have a node itself: then the path is empty.
    std::uint32_t trace(std::uint32_t start, const Paths& paths);
    /// Gathers the free points of the branch about the path, as wide as it takes, and moves the line to their
    /// middle: lines fitted to those near each of its nodes. `thickest` [m] is the radius of what it leaves.
    void shape(double thickest);
    /// Adds the line below `owner`, and says of its points that they are its own.
    std::uint32_t add_to(DraftTree& tree, std::vector<std::uint32_t>& node, std::uint32_t owner) const;

    std::span<const std::uint32_t> path() const { return path_; }  ///< from the base outward
    std::span<const Member> members() const { return members_; }   ///< after `shape`
    double spacing() const { return about_; }                      ///< [m] mean on the path
    double length() const;                                         ///< [m]

  private:
    void smooth();
    Member foot(std::uint32_t point, double about) const;
    double gather(double reach);
    void recentre();

    std::span<const Vec3> points_;
    const Graph& graph_;
    std::span<const float> spacing_;
    std::span<const std::uint32_t> node_;
    double step_;  // [spacing] between nodes

    std::vector<std::uint32_t> path_;
    std::vector<Vec3d> line_;
    std::vector<Member> members_;
    double about_ = 0, radius_ = 0;
    std::uint32_t round_ = 0;
    std::vector<std::uint32_t> seen_;  // per point, the last round that looked at it
    struct Moments {                   // of the points near a node of the line, in steps along it
        double w = 0, x = 0, xx = 0;
        Vec3d p, xp;
    };
    std::vector<Moments> moments_;
    std::vector<double> way_;
};

}  // namespace coppice::extract_internal
