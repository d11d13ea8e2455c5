#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <string>
#include <vector>

#include "coppice/base/box.h"
#include "coppice/base/column.h"
#include "coppice/base/vec.h"
#include "coppice/mesh/texture.h"

namespace coppice {

/// Vertices of a quad.
using Quad = std::array<std::uint32_t, 4>;
/// Vertices of a triangle.
using Triangle = std::array<std::uint32_t, 3>;

/// Indexed quad mesh: faces are counter-clockwise seen from outside. Indices are in range.
struct QuadMesh {
    Buffer<Vec3> positions;  ///< [m] relative to origin
    Buffer<Quad> quads;      ///< counter-clockwise
    Vec3d origin;            ///< [m] added back by writers
};

/// Indexed triangle mesh with the same conventions.
struct TriMesh {
    Buffer<Vec3> positions;      ///< [m] relative to origin
    Buffer<Triangle> triangles;  ///< counter-clockwise
    Vec3d origin;                ///< [m] added back by writers
};

/// Polygon mesh as stored in files: faces of three or more corners, not necessarily closed or manifold.
struct PolygonMesh {
    Buffer<Vec3> positions;                ///< [m] relative to origin
    std::vector<std::uint32_t> corners;    ///< corner vertices of all faces, concatenated
    std::vector<std::uint32_t> first{0};   ///< face f has corners first[f] .. first[f + 1]
    Vec3d origin;                          ///< [m] added back by writers
    std::vector<std::string> group_names;  ///< names of the groups or materials of the file
    std::vector<std::uint32_t> group;  ///< per face an index into group_names; empty if there are no groups
    /// one per corner, in the order of `corners`; empty if the mesh has no texture coordinates
    Buffer<TexturePoint> texture;
    Buffer<TextureBlend> texture_blends;  ///< one per corner; empty if there is no second set

    /// number of faces
    std::uint32_t face_count() const { return static_cast<std::uint32_t>(first.size()) - 1; }
    /// Returns the corner vertices of face f, in order.
    std::span<const std::uint32_t> face(std::uint32_t f) const {
        return {corners.data() + first[f], first[f + 1] - first[f]};
    }
    /// Appends a face of three or more corners.
    void add_face(std::span<const std::uint32_t> face_corners) {
        corners.insert(corners.end(), face_corners.begin(), face_corners.end());
        first.push_back(static_cast<std::uint32_t>(corners.size()));
    }
};

/// Converts the mesh to polygons. O(n).
PolygonMesh to_polygons(const QuadMesh& mesh);
/// Converts the mesh to polygons. O(n).
PolygonMesh to_polygons(const TriMesh& mesh);

/// Divides each quad along its shorter diagonal. O(n).
TriMesh triangulate(const QuadMesh& mesh);
/// Divides each quad along its shorter diagonal; larger faces become fans. O(n).
TriMesh triangulate(const PolygonMesh& mesh);

}  // namespace coppice
