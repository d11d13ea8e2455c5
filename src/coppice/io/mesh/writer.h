#pragma once

#include <filesystem>
#include <optional>
#include <span>

#include "coppice/base/context.h"
#include "coppice/io/file_up.h"
#include "coppice/io/mesh/format.h"
#include "coppice/mesh/mesh.h"
#include "coppice/mesh/texture.h"

namespace coppice {

/// What kind of mesh file is written.
struct MeshWriteOptions {
    std::optional<MeshFormat> format;  ///< nothing: as the extension of the name says
    FileUp up = FileUp::z;  ///< axis that points up in OBJ, PLY and STL; the others say which it is
    bool normals = false;   ///< also in OBJ: smooth normals
};

/// Writes a surface; the file appears whole or not at all (`AtomicFile`).
///
/// * OBJ, PLY, USDA: faces as they are. PLY is binary little endian.
/// * STL, GLB: triangles; quads are cut along their shorter diagonal, larger faces become fans.
/// * GLB: Y up, smooth normals, a plain brown material; the Khronos validator finds nothing wrong.
/// * USDA: Z up, metres, subdivisionScheme "none", smooth normals.
///
/// Coordinates: text holds the shortest digits that give back the same number. The origin is added in double
/// precision by OBJ and PLY (which then holds doubles); GLB and USDA keep it as the translation of the node;
/// STL can only round the sum; vertices that lie apart keep places of their own, so that a closed surface is
/// read back as one.
///
/// Same bytes for any number of threads. Cost: 1.8 million quads on two idle cores took 0.07 s as PLY and
/// 0.23 s as OBJ; memory stays below 32 MiB, plus 12 bytes per vertex where normals are written.
///
/// Throws `IoError` for trouble with the file; `Unsupported` for a name of no known kind, for OFF, and for a
/// mesh that the format cannot hold (GLB: more than 4 GiB; STL: rounding of more than 1e-5 of the size);
/// `InvalidInput` for a mesh without faces and for coordinates that are not finite; `Cancelled`. Indices are
/// taken to be in range.
void write_mesh(const std::filesystem::path& path, const QuadMesh& mesh, const MeshWriteOptions& options = {},
                const Context& ctx = {});
/// The same for triangles.
void write_mesh(const std::filesystem::path& path, const TriMesh& mesh, const MeshWriteOptions& options = {},
                const Context& ctx = {});
/// The same for faces of any number of corners.
void write_mesh(const std::filesystem::path& path, const PolygonMesh& mesh,
                const MeshWriteOptions& options = {}, const Context& ctx = {});

/// The same with places on a texture, one for each corner: OBJ and USDA hold them, with vertices as they are;
/// the others pass them over.
void write_textured_mesh(const std::filesystem::path& path, const PolygonMesh& mesh,
                         std::span<const TexturePoint> texture, const MeshWriteOptions& options = {},
                         const Context& ctx = {});

/// Writes a cage as USDA with subdivisionScheme "catmullClark", so that the reading program refines it.
/// Errors as above.
void write_cage(const std::filesystem::path& path, const QuadMesh& cage, const Context& ctx = {});

}  // namespace coppice
