#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

#include "coppice/mesh/mesh.h"

namespace coppice::measure_internal {

/// Points distributed evenly over a surface by area, numbered along its faces, so that consecutive points are
/// near each other.
class AreaPoints {
  public:
    /// Creates `count` points, or 0 if the surface has no area. The mesh must outlive the object. O(n).
    AreaPoints(const PolygonMesh& mesh, std::size_t count);

    std::size_t size() const { return count_; }

    /// Returns the middle of strip i of the area, relative to the mesh's origin. O(log n).
    Vec3d operator[](std::size_t i) const;

  private:
    double area(const Triangle& t) const;
    Vec3d spread(const Triangle& t, std::size_t i) const;

    const PolygonMesh& mesh_;
    std::size_t count_;
    std::vector<double> after_;  ///< [m^2] cumulative area up to and including each face
};

}  // namespace coppice::measure_internal
