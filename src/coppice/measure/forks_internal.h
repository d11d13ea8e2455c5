#pragma once

#include <cstddef>
#include <vector>

#include "coppice/base/context.h"
#include "coppice/skeleton/skeleton.h"
#include "coppice/spatial/box_tree.h"

namespace coppice::measure_internal {

/// The balls around the forks of a skeleton: nodes with at least three neighbours.
class Forks {
  public:
    /// `origin` must be the origin of the query points; `reach` is in radii of the nodes. O(n log n).
    Forks(const Skeleton& skeleton, Vec3d origin, double reach, const Context& ctx);

    std::size_t size() const { return balls_.size(); }
    /// Returns whether a point is in one of the balls. O(log n).
    bool contain(Vec3d p) const;

  private:
    struct Ball {
        Vec3d center;
        double radius;
    };
    static std::vector<Ball> balls(const Skeleton& s, Vec3d origin, double reach);
    static std::vector<Box3> compute_boxes(const std::vector<Ball>& balls);

    std::vector<Ball> balls_;
    BoxTree boxes_;
};

}  // namespace coppice::measure_internal
