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

/// Spatial index of the segments of a skeleton by rho: the distance from a point to the segment divided by
/// the segment's radius at the closest point. Capsules are numbered in the order of their child nodes. Nodes
/// without a segment are ignored.
class CapsuleTree {
  public:
    static constexpr double kFarthest = 1e9;  ///< [radii] maximum search distance

    /// `origin` must be the origin of the query points. The skeleton is not referenced afterwards. O(n).
    CapsuleTree(const Skeleton& skeleton, Vec3d origin, const Context& ctx = {});

    /// Builds the index of cones in the frame of the query points, each with its child node. O(n).
    CapsuleTree(std::vector<NodeId> nodes, std::vector<RoundCone> cones, const Context& ctx = {});

    /// Returns the number of capsules.
    std::uint32_t size() const { return static_cast<std::uint32_t>(cones_.size()); }
    const RoundCone& cone(std::uint32_t i) const { return cones_[i]; }  ///< i < size()
    /// Returns the child node of segment i.
    NodeId node(std::uint32_t i) const { return nodes_[i]; }

    /// The result of `nearest`.
    struct Nearest {
        std::uint32_t capsule = kNoIndex;  ///< kNoIndex if there are no capsules
        double rho = kFarthest;            ///< rho of that capsule
    };
    /// Returns the capsule with the smallest rho; of equal ones the first, within rounding. A good guess as
    /// `hint` saves time. O(log n).
    Nearest nearest(Vec3d p, std::uint32_t hint = kNoIndex) const;

    static constexpr std::size_t kBlock = 16;  ///< maximum number of points of one query
    /// The same for at most kBlock points; fastest if they are near each other.
    void nearest(std::span<const Vec3d> points, std::uint32_t hint, std::span<Nearest> out) const;

    /// Returns whether a capsule other than `except` has a rho smaller than `rho`.
    bool any_within(Vec3d p, double rho, std::uint32_t except) const;

    /// Calls visit(capsule, closest) for the capsules that contain p, some of them more than once, until it
    /// returns false.
    template <class Visit>
    void visit_containing(Vec3d p, const Visit& visit) const {
        double limit = 1;
        boxes_.search([&](std::uint32_t l, std::uint32_t i) { return bound(l, i, p); }, limit,
                      [&](std::uint32_t section) {
                          const std::uint32_t i = compute_capsule(section);
                          const RoundCone::ClosestPoint closest = cones_[i].closest_point(p);
                          if (limit > 0 && closest.relative_squared() <= 1 && !visit(i, closest)) limit = -1;
                      });
    }

    /// Returns the distance from p to the nearest axis; infinite if there are no axes. O(log n).
    double axis_distance(Vec3d p) const;

    /// Calls visit(capsule, distance squared) for the capsules with an axis within sqrt(`limit_squared`) of
    /// p, mostly from near to far, some of them more than once; visit may lower the limit.
    template <class Visit>
    void visit_near(Vec3d p, const double& limit_squared, const Visit& visit) const {
        const auto to_box = [&](std::uint32_t l, std::uint32_t i) {
            return distance_squared(boxes_.level(l)[i], p);
        };
        boxes_.search(to_box, limit_squared, [&](std::uint32_t section) {
            const std::uint32_t i = compute_capsule(section);
            const double d2 = length_squared(cones_[i].closest_point(p).offset);
            if (d2 <= limit_squared) visit(i, d2);
        });
    }

  private:
    double bound(std::uint32_t level, std::uint32_t i, Vec3d p) const {
        return distance_squared(boxes_.level(level)[i], p) * inverse_radius_squared_[level][i];
    }
    std::uint32_t compute_capsule(std::uint32_t section) const { return section / sections_; }

    std::vector<NodeId> nodes_;
    std::vector<RoundCone> cones_;
    std::uint32_t sections_ = 1;  ///< number of sections per axis, each with its own box
    BoxTree boxes_;               ///< of the sections; those of one axis are consecutive
    /// By level and box: of the largest radius in it.
    std::vector<std::vector<double>> inverse_radius_squared_;
};

/// Calls use(i, nearest) in parallel for every i < count with the capsule that is nearest to point(i), a
/// Vec3d. Much faster if consecutive points are near each other. Throws Cancelled.
template <class Point, class Use>
void for_each_nearest(const CapsuleTree& capsules, const Context& ctx, std::size_t count, const Point& point,
                      const Use& use) {
    constexpr std::size_t kGrain = 1024;
    parallel_for_ranges(ctx, count, kGrain, [&](IndexRange range) {
        std::uint32_t hint = kNoIndex;
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

/// The smallest distance between two segments, and its parameters on both.
struct SegmentGap {
    double distance;  ///< [m]
    double s;         ///< parameter on the first segment: 0 at a, 1 at b
    double t;         ///< parameter on the second segment
};
/// Returns the gap of two segments in the same frame. O(1).
SegmentGap gap(const RoundCone& a, const RoundCone& b);

}  // namespace coppice
