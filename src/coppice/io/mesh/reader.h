#pragma once

#include <filesystem>
#include <string>
#include <string_view>

#include "coppice/base/context.h"
#include "coppice/io/mesh/format.h"
#include "coppice/mesh/mesh.h"

namespace coppice {

/// Reads a surface from OBJ, PLY, OFF, STL or GLB. What the content says goes before the extension of the
/// name.
///
/// Faces come as the file has them, in its order, with three or more corners each: not made closed, manifold
/// or consistent, but every index is in range and every coordinate finite. Vertices come as the file has them
/// too; only STL, which repeats them for each triangle, is welded: equal positions become one vertex. GLB:
/// the triangles of the default scene under the transforms of its nodes, turned from Y up to Z up. Colours,
/// normals, texture coordinates, lines and points are passed over. The groups of OBJ and GLB are named by
/// what the file tells of object (mesh), group and material, as in "tree/bark".
///
/// Where coordinates are large against the size of the mesh, `origin` takes the offset in double precision,
/// so that the float positions keep their digits; else it is zero.
///
/// Throws, each with one sentence that names the file and the line or face: `IoError` (see `read_file`),
/// `InvalidInput` for damaged or cut files, `Unsupported` for what is not handled (compressed or external
/// glTF buffers, binary OFF, other kinds of files); `Cancelled`. Cost: linear (STL: n log n); memory is
/// bounded by a small multiple of the file.
PolygonMesh read_mesh(const std::filesystem::path& path, const Context& ctx = {});

/// The same from memory; `source` names it in messages. USDA is `Unsupported`.
PolygonMesh parse_mesh(std::string_view bytes, MeshFormat format, const std::string& source,
                       const Context& ctx = {});

}  // namespace coppice
