#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "coppice/base/context.h"
#include "coppice/mesh/mesh.h"
#include "coppice/spatial/box_tree.h"

namespace coppice {

/// The triangles of a mesh, found by place. Quads are cut along their shorter diagonal, larger faces into
/// fans; triangles without area are left out. The items of the tree are pieces: one triangle, or two
/// neighbours of one face.
class SurfaceTree {
  public:
    /// The mesh must be valid and outlive the tree. O(n); about 90 bytes per quad.
    explicit SurfaceTree(const PolygonMesh& mesh, const Context& ctx = {});

    /// Triangles of one face that share a box.
    struct Piece {
        std::uint32_t face = 0;   ///< the face they are from
        std::uint32_t first = 0;  ///< triangles first .. first + count
        std::uint32_t count = 0;  ///< how many
    };

    const PolygonMesh& mesh() const { return *mesh_; }                      ///< the one it was made of
    const BoxTree& boxes() const { return boxes_; }                         ///< of the pieces
    const Piece& piece(std::uint32_t item) const { return pieces_[item]; }  ///< an item of boxes()
    /// The triangles of a piece.
    std::span<const Triangle> triangles(const Piece& piece) const {
        return std::span(triangles_).subspan(piece.first, piece.count);
    }

    /// The distance from a point to the surface; infinite when that is empty. O(log n) near the surface.
    double distance(Vec3d p) const;

    /// Whether the surface comes as near as that. Cheaper than the distance where it does.
    bool is_within(Vec3d p, double distance) const;

    /// The same as `distance`, negative behind the nearest face: inside of a closed surface of faces that run
    /// counter-clockwise seen from outside. Where several faces are equally near, on an edge or a corner, the
    /// one that p lies most squarely before decides. O(log n).
    double signed_distance(Vec3d p) const;

  private:
    struct Parts;
    SurfaceTree(const PolygonMesh& mesh, Parts&& parts, const Context& ctx);

    const PolygonMesh* mesh_;
    std::vector<Triangle> triangles_;
    std::vector<Piece> pieces_;
    BoxTree boxes_;
};

/// The distance from p to the triangle a, b, c, squared [Ericson2005].
double distance_squared(Vec3d p, Vec3d a, Vec3d b, Vec3d c);

}  // namespace coppice
