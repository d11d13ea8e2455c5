#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

#include "coppice/mesh/mesh.h"

namespace coppice::measure_internal {

/// Points spread evenly over a surface by area, numbered along its faces, so that those that follow each
/// other lie near each other.
class AreaPoints {
  public:
    /// `count` of them, none where the surface has no area. The mesh must outlive them. O(n).
    AreaPoints(const PolygonMesh& mesh, std::size_t count);

    std::size_t size() const { return count_; }

    /// The middle of the strip of area that is number i, relative to the mesh's origin. O(log n).
    Vec3d operator[](std::size_t i) const;

  private:
    double area(const Triangle& t) const;
    Vec3d spread(const Triangle& t, std::size_t i) const;

    const PolygonMesh& mesh_;
    std::size_t count_;
    std::vector<double> after_;  ///< [m^2] of all faces up to each
};

}  // namespace coppice::measure_internal
