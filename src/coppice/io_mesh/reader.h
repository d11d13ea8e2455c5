#pragma once

#include <filesystem>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "coppice/base/context.h"
#include "coppice/base/vec.h"
#include "coppice/io_mesh/format.h"
#include "coppice/mesh/mesh.h"
#include "coppice/mesh/vertex_attribute.h"

namespace coppice {

/// Reads a surface from OBJ, PLY, OFF, STL or GLB. The content of the file has precedence over its extension.
///
/// Faces are returned as in the file, in its order, with three or more corners each: they need not be closed,
/// manifold or consistently oriented, but every index is in range and every coordinate finite. Vertices are
/// returned as in the file too; only STL, which repeats them for each triangle, and PLY and GLB with texture
/// coordinates, which repeat them along seams, are welded: equal positions become one vertex. GLB: the
/// triangles of the default scene, transformed by its nodes and rotated from Y up to Z up, with all copies of
/// EXT_mesh_gpu_instancing. Colours, normals, lines and points are ignored. The groups of OBJ and GLB are
/// named by object (mesh), group and material as far as the file specifies them, as in "tree/bark".
///
/// Texture coordinates are returned by corner: those of OBJ (vt), the properties s and t, u and v, or
/// texture_u and texture_v of the vertices of PLY, and TEXCOORD_0 of GLB, with v up in the image. Corners
/// without coordinates have (0, 0) if others have some. A second set with weights is read too: s1, t1 and
/// blend of PLY, and TEXCOORD_1 with _BLEND of GLB.
///
/// If coordinates are large relative to the size of the mesh, `origin` stores the offset in double precision,
/// so that the float positions keep their accuracy; otherwise it is zero.
///
/// Throws, each with one sentence that names the file and the line or face: `IoError` (see `read_file`),
/// `InvalidInput` for damaged or truncated files, `Unsupported` for content that is not supported (compressed
/// or external glTF buffers, binary OFF, other kinds of files); `Cancelled`. Cost: linear (STL: n log n);
/// memory is bounded by a small multiple of the size of the file.
PolygonMesh read_mesh(const std::filesystem::path& path, const Context& ctx = {});

/// Reads a surface from memory; `source` names it in messages. Throws `Unsupported` for USDA.
PolygonMesh parse_mesh(std::string_view bytes, MeshFormat format, const std::string& source,
                       const Context& ctx = {});

/// A surface with numbers of its vertices.
struct MeshFile {
    PolygonMesh mesh;                         ///< the surface
    std::vector<VertexAttribute> attributes;  ///< those of the requested ones that the file contains
};

/// Reads a surface as `read_mesh`, with the attributes of these names: `order` is `_ORDER` in GLB, and a
/// property of the vertices in PLY; other formats have none. Vertices without a value, and values that are
/// not finite or beyond 1e30, have NaN. Welded vertices have the values of the first of them.
MeshFile read_mesh_file(const std::filesystem::path& path, std::span<const std::string> attributes,
                        const Context& ctx = {});

/// Reads a surface from memory with attributes; `source` names it in messages. Throws `Unsupported` for USDA.
MeshFile parse_mesh_file(std::string_view bytes, MeshFormat format, const std::string& source,
                         std::span<const std::string> attributes, const Context& ctx = {});

/// Returns the vertices of an OFF file without faces. Throws `InvalidInput` for others.
std::vector<Vec3d> parse_off_points(std::string_view text, const std::string& source, const Context& ctx);

}  // namespace coppice
