#pragma once

#include <cstddef>
#include <vector>

#include "coppice/base/context.h"
#include "coppice/skeleton/skeleton.h"
#include "coppice/spatial/box_tree.h"

namespace coppice::measure_internal {

/// The balls around the nodes of a skeleton where it forks: those with three neighbours or more.
class Forks {
  public:
    /// `origin` is that of the points that will be asked about; `reach` in radii of the nodes. O(n log n).
    Forks(const Skeleton& skeleton, Vec3d origin, double reach, const Context& ctx);

    std::size_t size() const { return balls_.size(); }
    /// Whether a point lies in one of the balls. O(log n).
    bool contain(Vec3d p) const;

  private:
    struct Ball {
        Vec3d center;
        double radius;
    };
    static std::vector<Ball> balls(const Skeleton& s, Vec3d origin, double reach);
    static std::vector<Box3> boxes_of(const std::vector<Ball>& balls);

    std::vector<Ball> balls_;
    BoxTree boxes_;
};

}  // namespace coppice::measure_internal
