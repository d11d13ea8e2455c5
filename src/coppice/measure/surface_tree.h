#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "coppice/base/context.h"
#include "coppice/mesh/mesh.h"
#include "coppice/spatial/box_tree.h"

namespace coppice {

/// Spatial index of the triangles of a mesh. Quads are split along their shorter diagonal, larger faces into
/// fans; triangles without area are omitted. An item of the tree is one triangle, or two adjacent triangles
/// of one face.
class SurfaceTree {
  public:
    /// The mesh must be valid and outlive the tree. O(n); about 90 bytes per quad.
    explicit SurfaceTree(const PolygonMesh& mesh, const Context& ctx = {});

    /// Triangles of one face that share a box.
    struct TriangleRun {
        std::uint32_t face = 0;   ///< the face that contains them
        std::uint32_t first = 0;  ///< triangles first .. first + count
        std::uint32_t count = 0;  ///< number of triangles
    };

    const PolygonMesh& mesh() const { return *mesh_; }                        ///< the indexed mesh
    const BoxTree& boxes() const { return boxes_; }                           ///< of the runs
    const TriangleRun& run(std::uint32_t item) const { return runs_[item]; }  ///< an item of boxes()
    /// Returns the triangles of a run.
    std::span<const Triangle> triangles(const TriangleRun& run) const {
        return std::span(triangles_).subspan(run.first, run.count);
    }

    /// Returns the distance from a point to the surface; infinite if that is empty. O(log n) near the
    /// surface.
    double distance(Vec3d p) const;

    /// Returns whether the distance from a point to the surface is at most `distance`. Faster than distance()
    /// if it is.
    bool is_within(Vec3d p, double distance) const;

    /// The same as `distance`, negative behind the nearest face: inside a closed surface with faces that are
    /// counter-clockwise seen from outside. If several faces are equally near, at an edge or a corner, the
    /// one with the largest distance from its plane to p decides. O(log n).
    double signed_distance(Vec3d p) const;

  private:
    struct Collection;
    SurfaceTree(const PolygonMesh& mesh, Collection&& collection, const Context& ctx);

    const PolygonMesh* mesh_;
    std::vector<Triangle> triangles_;
    std::vector<TriangleRun> runs_;
    BoxTree boxes_;
};

/// Returns the squared distance from p to the triangle a, b, c [Ericson2005].
double distance_squared(Vec3d p, Vec3d a, Vec3d b, Vec3d c);

}  // namespace coppice
