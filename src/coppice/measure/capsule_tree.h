#pragma once

#include <algorithm>
#include <array>
#include <cstdint>
#include <limits>
#include <span>
#include <vector>

#include "coppice/base/context.h"
#include "coppice/base/id.h"
#include "coppice/base/kernel/round_cone.h"
#include "coppice/base/parallel.h"
#include "coppice/skeleton/skeleton.h"
#include "coppice/spatial/box_tree.h"

namespace coppice {

/// The segments of a skeleton, found by rho: the distance from a point to the segment over the segment's
/// radius at the foot. Capsules are numbered in the order of their child nodes. Nodes without a segment are
/// not seen.
class CapsuleTree {
  public:
    static constexpr std::uint32_t kNone = std::numeric_limits<std::uint32_t>::max();  ///< no capsule
    static constexpr double kFarthest = 1e9;  ///< in radii; nothing is seen beyond

    /// `origin` is that of the points that will be asked about. The skeleton may go afterwards. O(n).
    CapsuleTree(const Skeleton& skeleton, Vec3d origin, const Context& ctx = {});

    /// Of cones in the frame of the points, each with the node that names it. O(n).
    CapsuleTree(std::vector<NodeId> nodes, std::vector<RoundCone> cones, const Context& ctx = {});

    /// number of capsules
    std::uint32_t size() const { return static_cast<std::uint32_t>(cones_.size()); }
    const RoundCone& cone(std::uint32_t i) const { return cones_[i]; }  ///< i < size()
    /// The child node of segment i, which names it.
    NodeId node(std::uint32_t i) const { return nodes_[i]; }

    /// What `nearest` found.
    struct Nearest {
        std::uint32_t capsule = kNone;  ///< kNone where there are none
        double rho = kFarthest;         ///< of that capsule
    };
    /// The capsule of least rho; of equal ones the first, as far as rounding tells. A good guess as `hint`
    /// saves time. O(log n).
    Nearest nearest(Vec3d p, std::uint32_t hint = kNone) const;

    static constexpr std::size_t kBlock = 16;  ///< points at most that are asked about at once
    /// The same for kBlock points or fewer, which costs least where they are near each other.
    void nearest(std::span<const Vec3d> points, std::uint32_t hint, std::span<Nearest> out) const;

    /// Whether a capsule other than `except` has rho below `rho`.
    bool any_within(Vec3d p, double rho, std::uint32_t except) const;

    /// Calls visit(capsule, foot) for the capsules that have p, some of them more than once, until it returns
    /// false.
    template <class Visit>
    void visit_containing(Vec3d p, const Visit& visit) const {
        double limit = 1;
        boxes_.search([&](std::uint32_t l, std::uint32_t i) { return bound(l, i, p); }, limit,
                      [&](std::uint32_t piece) {
                          const std::uint32_t i = capsule_of(piece);
                          const RoundCone::Foot foot = cones_[i].foot(p);
                          if (limit > 0 && foot.relative_squared() <= 1 && !visit(i, foot)) limit = -1;
                      });
    }

    /// The distance from p to the nearest axis; infinite where there is none. O(log n).
    double axis_distance(Vec3d p) const;

    /// Calls visit(capsule, distance squared) for the capsules whose axis lies within the root of
    /// `limit_squared` of p, mostly from near to far, some of them more than once; visit may lower the limit.
    template <class Visit>
    void visit_near(Vec3d p, const double& limit_squared, const Visit& visit) const {
        const auto to_box = [&](std::uint32_t l, std::uint32_t i) {
            return distance_squared(boxes_.level(l)[i], p);
        };
        boxes_.search(to_box, limit_squared, [&](std::uint32_t piece) {
            const std::uint32_t i = capsule_of(piece);
            const double d2 = length_squared(cones_[i].foot(p).offset);
            if (d2 <= limit_squared) visit(i, d2);
        });
    }

  private:
    double bound(std::uint32_t level, std::uint32_t i, Vec3d p) const {
        return distance_squared(boxes_.level(level)[i], p) * inverse_radius_squared_[level][i];
    }
    std::uint32_t capsule_of(std::uint32_t piece) const { return piece / pieces_; }

    std::vector<NodeId> nodes_;
    std::vector<RoundCone> cones_;
    std::uint32_t pieces_ = 1;  ///< that every axis is cut into, each with a box of its own
    BoxTree boxes_;             ///< of the pieces, those of one axis after each other
    std::vector<std::vector<double>>
        inverse_radius_squared_;  ///< by level and box: of the greatest radius in it
};

/// Calls use(i, nearest) for every i < count with the capsule that is nearest to point(i), a Vec3d, in
/// parallel. Much quicker where points that follow each other are near each other. Throws Cancelled.
template <class Point, class Use>
void for_each_nearest(const CapsuleTree& capsules, const Context& ctx, std::size_t count, const Point& point,
                      const Use& use) {
    constexpr std::size_t kGrain = 1024;
    parallel_for_ranges(ctx, count, kGrain, [&](IndexRange range) {
        std::uint32_t hint = CapsuleTree::kNone;
        std::array<Vec3d, CapsuleTree::kBlock> points;
        std::array<CapsuleTree::Nearest, CapsuleTree::kBlock> found;
        for (std::size_t first = range.begin; first < range.end; first += points.size()) {
            const std::size_t n = std::min(points.size(), range.end - first);
            for (std::size_t k = 0; k < n; ++k) points[k] = point(first + k);
            capsules.nearest(std::span(points).first(n), hint, std::span(found).first(n));
            for (std::size_t k = 0; k < n; ++k) use(first + k, found[k]);
            hint = found[n - 1].capsule;
        }
    });
}

/// The least distance between two segments, and where it is taken on each.
struct SegmentGap {
    double distance;  ///< [m]
    double s;         ///< where on the first: 0 at a, 1 at b
    double t;         ///< where on the second
};
/// Of two segments, in the same frame. O(1).
SegmentGap gap(const RoundCone& a, const RoundCone& b);

}  // namespace coppice
