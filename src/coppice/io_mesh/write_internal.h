#pragma once

#include <cstdint>
#include <filesystem>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "coppice/base/compressed_rows.h"
#include "coppice/base/context.h"
#include "coppice/io/file_up.h"
#include "coppice/io/item_writer.h"
#include "coppice/io_mesh/instanced_parts.h"
#include "coppice/io_mesh/material.h"
#include "coppice/mesh/mesh.h"
#include "coppice/mesh/texture.h"
#include "coppice/mesh/texture_table.h"
#include "coppice/mesh/vertex_attribute.h"
#include "coppice/system/file.h"

namespace coppice::io_internal {

/// Linear colour of surfaces without a material.
inline constexpr Vec3d kPlainColor{0.32, 0.22, 0.15};

static_assert(sizeof(Vec3) == 3 * sizeof(float));

/// Successive faces of an OBJ file.
struct NamedGroup {
    std::size_t first_face = 0;  ///< up to that of the next group
    std::string name;
};

/// A view of any of the mesh types, without a copy.
struct MeshView {
    explicit MeshView(const QuadMesh& m)
        : positions(m.positions),
          origin(m.origin),
          corners(m.quads.empty() ? nullptr : m.quads[0].data()),
          face_count(m.quads.size()),
          sides(4) {}
    explicit MeshView(const TriMesh& m)
        : positions(m.positions),
          origin(m.origin),
          corners(m.triangles.empty() ? nullptr : m.triangles[0].data()),
          face_count(m.triangles.size()),
          sides(3) {}
    explicit MeshView(const PolygonMesh& m)
        : positions(m.positions),
          origin(m.origin),
          corners(m.corners.data()),
          first(m.first.data()),
          face_count(m.face_count()) {}

    std::size_t first_corner(std::size_t f) const { return first != nullptr ? first[f] : f * sides; }
    std::span<const std::uint32_t> face(std::size_t f) const {
        return {corners + first_corner(f), first_corner(f + 1) - first_corner(f)};
    }
    /// A face with n corners becomes n - 2 triangles, so the index of the first triangle of a face follows
    /// from its first corner.
    std::size_t triangle_count() const { return first_corner(face_count) - 2 * face_count; }
    bool has_origin() const { return origin != Vec3d{}; }

    std::span<const Vec3> positions;
    Vec3d origin;
    const std::uint32_t* corners = nullptr;
    const std::uint32_t* first = nullptr;  ///< offsets of faces of different sizes; null otherwise
    std::size_t face_count = 0;
    std::size_t sides = 0;
    std::span<const TexturePoint> texture;          ///< one for every corner; may be empty
    std::span<const TextureBlend> texture_blends;   ///< the second set; one for every corner, or empty
    std::span<const MaterialFiles> materials;       ///< of meshes with texture; may be empty
    std::span<const std::uint32_t> face_materials;  ///< index of the material of each face; empty: 0
    const InstancedParts* parts = nullptr;          ///< placed copies, for GLB and USDA; may be null
    std::span<const NamedGroup> groups;             ///< for OBJ; may be empty
    std::filesystem::path path;                     ///< of the file, for names relative to it
    std::span<const Vec3> normals;                  ///< one for every vertex, for OBJ; may be empty
    std::span<const VertexAttribute> attributes;    ///< of the vertices
    FileUp up = FileUp::z;                          ///< up axis named by the comments of OBJ and PLY
};

/// Returns the table of a mesh with texture coordinates; empty without. O(n).
TextureTable texture_table(const MeshView& mesh);

/// A mesh with one vertex for every place of its texture, for formats with coordinates by vertex.
struct SplitMesh {
    explicit SplitMesh(const MeshView& mesh);
    SplitMesh(const SplitMesh&) = delete;
    SplitMesh& operator=(const SplitMesh&) = delete;
    ~SplitMesh() = default;

    /// Divides the faces into triangles, and the vertices as [Mikkelsen2008] does: the triangles around a
    /// vertex are connected by edges, and the texture is mirrored in all of them or in none. O(n), n log n in
    /// the valence.
    void divide_for_tangents(const Context& ctx);

    /// Returns the vertex of the given mesh for one of the split mesh; the same without a split mesh.
    static std::size_t original(const std::optional<SplitMesh>& split, std::size_t v) {
        return split ? split->table.vertex[v] : v;
    }

    TextureTable table;  ///< without `of_corner` after a division
    std::vector<Vec3> positions;
    Buffer<Triangle> triangles;                 ///< after a division
    std::vector<std::uint32_t> face_materials;  ///< of the triangles, if the faces have some
    /// Corners of the triangles at each vertex that existed before a division; set by it.
    CompressedRows<std::uint32_t> corners;
    MeshView view;  ///< refers to the members above
};

/// Returns the vectors of the vertices of a split mesh from those of the original ones.
std::vector<Vec3> split_vectors(std::span<const Vec3> vectors, const SplitMesh& split);

/// Calls emit(a, b, c) for each triangle of face f: along the shorter diagonal of quads, otherwise as a fan.
template <class Emit>
void for_each_triangle(const MeshView& mesh, std::size_t f, const Emit& emit) {
    const auto c = mesh.face(f);
    const auto& x = mesh.positions;
    if (c.size() == 4 && length_squared(x[c[1]] - x[c[3]]) < length_squared(x[c[0]] - x[c[2]])) {
        emit(c[1], c[2], c[3]);
        emit(c[1], c[3], c[0]);
        return;
    }
    for (std::size_t k = 1; k + 1 < c.size(); ++k) emit(c[0], c[k], c[k + 1]);
}

/// Returns unit normals of vertices, the area-weighted mean of the adjacent faces; +Z if they cancel. The
/// faces are added sequentially, because another order would change the rounding.
std::vector<Vec3> smooth_normals(const MeshView& mesh);

/// Tangent of a vertex: the direction in which u increases on the surface.
struct Tangent {
    Vec3 direction;  ///< unit, perpendicular to the normal
    float sign = 1;  ///< -1 where the texture is mirrored
};

/// Returns the tangents of the vertices of a mesh that was divided for them: those of [Mikkelsen2008], for
/// which normal maps are made. The same for any number of threads. O(n).
std::vector<Tangent> compute_tangents(const SplitMesh& mesh, std::span<const Vec3> normals,
                                      const Context& ctx);

enum class Subdivision { none, catmull_clark };

void write_obj(AtomicFile& file, const MeshView& mesh, const Context& ctx);
void write_ply(AtomicFile& file, const MeshView& mesh, const Context& ctx);
void write_stl(AtomicFile& file, const MeshView& mesh, const Context& ctx);
void write_glb(AtomicFile& file, const MeshView& mesh, const Context& ctx);
void write_usda(AtomicFile& file, const MeshView& mesh, Subdivision subdivision, const Context& ctx);

}  // namespace coppice::io_internal
