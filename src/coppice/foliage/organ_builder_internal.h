#pragma once

#include <cstdint>
#include <utility>
#include <vector>

#include "coppice/base/vec.h"
#include "coppice/foliage/organ_shape.h"
#include "coppice/foliage/outline_internal.h"

namespace coppice::foliage_internal {

/// A place in a cluster with its axes.
struct OrganFrame {
    Vec3 origin;  ///< [m]
    Vec3 across;  ///< unit vector
    Vec3 along;   ///< unit vector, the axis
    Vec3 up;      ///< cross(across, along)
    /// Returns the unit vector across the axis at an angle around it.
    Vec3 around(float azimuth) const;
    /// [m] Returns a point by its distance from the axis, the angle around it, and the distance along it.
    Vec3 point(float radius, float azimuth, float height) const;
};

/// Returns a frame with this axis.
OrganFrame make_organ_frame(Vec3 origin, Vec3 along);

/// Collects the triangles of one part of a cluster.
class OrganBuilder {
  public:
    /// Adds a surface of revolution: points (radius, height) from one pole to the other, which have radius 0.
    void add_revolution(const OrganFrame& frame, const std::vector<Point2>& profile, int sides);
    /// Adds a closed tube that becomes thinner by a quarter.
    void add_tube(Vec3 from, Vec3 to, float width);
    /// Adds the sides of a pyramid with three sides; its base is open.
    void add_spine(const OrganFrame& frame, float width, float length);
    /// Adds the faces between rows of points from the left to the right, seen from above; all rows have the
    /// same number of points, or one.
    void add_rows(const std::vector<std::vector<Vec3>>& rows);
    /// Adds a triangle.
    void add_triangle(Vec3 a, Vec3 b, Vec3 c);

    bool empty() const { return mesh_.triangles.empty(); }  ///< whether there are no triangles
    /// Returns the mesh and removes it.
    Prototype take(std::uint32_t material);

  private:
    std::uint32_t add(Vec3 p);
    void add_face(std::uint32_t a, std::uint32_t b, std::uint32_t c);

    TriMesh mesh_;
};

}  // namespace coppice::foliage_internal
