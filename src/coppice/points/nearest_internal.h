#pragma once

#include <cstddef>
#include <memory>
#include <span>

#include "coppice/base/vec.h"

namespace coppice::points_internal {

/// The nearest of a fixed set of points; a kd-tree, so that no arrangement of the points makes it slow.
/// Refers to the points.
class NearestPoint {
  public:
    /// At least one point.
    explicit NearestPoint(std::span<const Vec3> points);
    ~NearestPoint();
    NearestPoint(NearestPoint&&) noexcept;

    std::size_t index(Vec3 p) const;
    double squared_distance(Vec3 p) const;
    /// From point i to the nearest other one; at least two points.
    double squared_distance_to_other(std::size_t i) const;

  private:
    struct Tree;
    std::unique_ptr<Tree> tree_;
};

}  // namespace coppice::points_internal
