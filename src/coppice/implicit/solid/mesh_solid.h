#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include "coppice/base/context.h"
#include "coppice/implicit/shape/shape.h"
#include "coppice/spatial/box_tree.h"

namespace coppice {

/// A triangle mesh as a solid. The distance is exact; inside is where the mesh winds around a point by more
/// than half a turn [Jacobson2013], found in O(log n) by taking far parts of the mesh for one dipole each
/// [Barill2018]. So small holes, overlaps and parts within parts do no harm: a hole is closed by an invisible
/// patch, across which the distance changes its sign.
class MeshSolid final : public Shape {
  public:
    using Triangle = std::array<std::uint32_t, 3>;  ///< numbers of three positions

    /// The mesh is copied. Triangles turn counterclockwise seen from outside; a mesh that is inside out is
    /// turned. Triangles without area are left out. Throws InvalidInput for positions that are not numbers or
    /// beyond 1e9 m, numbers of positions that do not exist, more than 100 million triangles, and meshes that
    /// enclose nothing. O(n); about 100 bytes a triangle.
    MeshSolid(std::span<const Vec3> positions, std::span<const Triangle> triangles, const Context& ctx = {});

    Box3 bounds() const override { return bounds_; }

    /// O(log n) a point near the surface; fastest when neighbours in the batch are neighbours in space.
    void distance(std::span<const Vec3> points, std::span<FieldSample> out) const override;
    bool is_closed() const override { return true; }

    /// How often the mesh winds around p: 1 inside and 0 outside a closed mesh, within 0.05.
    double winding(Vec3d p) const;

    /// Whether every edge is run along as often one way as the other; equal positions count as one.
    bool is_watertight() const { return watertight_; }

  private:
    struct Corners {
        Vec3 a, b, c;
    };
    /// What a part of the mesh looks like from afar.
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

    std::vector<Corners> triangles_;  ///< by place in the tree
    BoxTree boxes_;
    std::vector<std::vector<Dipole>> dipoles_;  ///< by level; level 0 is left out
    Box3 bounds_;
    double orientation_ = 1;
    bool watertight_ = false;
};

}  // namespace coppice
