#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include "coppice/base/context.h"
#include "coppice/implicit/shape/shape.h"
#include "coppice/spatial/box_tree.h"

namespace coppice {

/// A triangle mesh as a solid. The distance is exact; points with a winding number above one half
/// [Jacobson2013] are inside, computed in O(log n) by approximating distant portions of the mesh by one
/// dipole each [Barill2018]. Small holes, overlaps and nested components are therefore permitted: a hole is
/// closed by an invisible patch, across which the distance changes its sign.
class MeshSolid final : public Shape {
  public:
    using Triangle = std::array<std::uint32_t, 3>;  ///< indices of three positions

    /// The mesh is copied. Triangles must be counter-clockwise seen from outside; a mesh that is inside out
    /// is reversed. Triangles without area are ignored. Throws InvalidInput for positions that are NaN or
    /// beyond 1e9 m, invalid indices of positions, more than 100 million triangles, and meshes that enclose
    /// nothing. O(n); about 100 bytes per triangle.
    MeshSolid(std::span<const Vec3> positions, std::span<const Triangle> triangles, const Context& ctx = {});

    Box3 bounds() const override { return bounds_; }

    /// O(log n) per point near the surface; fastest if consecutive points are close in space.
    void distance(std::span<const Vec3> points, std::span<FieldSample> out) const override;
    bool is_closed() const override { return true; }

    /// Returns the winding number of the mesh around p: 1 inside and 0 outside a closed mesh, within 0.05.
    double winding(Vec3d p) const;

    /// Returns whether every edge occurs equally often in both directions; equal positions are identified.
    bool is_watertight() const { return watertight_; }

  private:
    struct Corners {
        Vec3 a, b, c;
    };
    /// Approximation of a distant portion of the mesh.
    struct Dipole {
        Vec3 center;
        float radius = 0;
        Vec3 moment;  ///< [m^2] sum of areas times normals
    };
    struct Nearest {
        std::uint32_t triangle = 0;
        double squared;
        Vec3d point;
    };

    void build_dipoles(const Context& ctx);
    double winding_of_triangles(std::uint32_t first, std::uint32_t end, Vec3d p) const;
    double winding_below(std::uint32_t level, std::uint32_t parent, Vec3d p) const;
    Nearest nearest(Vec3d p, std::uint32_t hint) const;

    std::vector<Corners> triangles_;  ///< by index in the tree
    BoxTree boxes_;
    std::vector<std::vector<Dipole>> dipoles_;  ///< by level; level 0 is omitted
    Box3 bounds_;
    double orientation_ = 1;
    bool watertight_ = false;
};

}  // namespace coppice
