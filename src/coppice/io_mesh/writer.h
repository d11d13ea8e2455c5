#pragma once

#include <filesystem>
#include <optional>
#include <span>
#include <vector>

#include "coppice/base/context.h"
#include "coppice/io/file_up.h"
#include "coppice/io_mesh/format.h"
#include "coppice/io_mesh/instanced_parts.h"
#include "coppice/io_mesh/material.h"
#include "coppice/mesh/mesh.h"
#include "coppice/mesh/texture.h"
#include "coppice/mesh/vertex_attribute.h"

namespace coppice {

/// Options for writing a mesh file.
struct MeshWriteOptions {
    std::optional<MeshFormat> format;  ///< nullopt: by the extension of the name
    FileUp up = FileUp::z;             ///< up axis of OBJ, PLY and STL; the other formats specify theirs
    bool normals = false;              ///< also writes smooth normals in OBJ
    /// Texture coordinates, one per corner of the faces; may be empty. OBJ and USDA store them by corner, PLY
    /// and GLB by vertex: vertices on seams are written several times. STL has none.
    std::span<const TexturePoint> texture;
    /// A second set of texture coordinates with weights, one per corner of the faces; may be empty, and needs
    /// the first. `TEXCOORD_1` and `_BLEND` in GLB, s1, t1 and blend in PLY, and `primvars:st1` and
    /// `primvars:blend` in USDA; OBJ and STL have none.
    std::span<const TextureBlend> texture_blends;
    /// Attributes of the vertices; may be empty. `order` is `_ORDER` in GLB, a property of the vertices in
    /// PLY, and `primvars:order` in USDA; OBJ and STL have none.
    std::span<const VertexAttribute> attributes;
    /// Materials of surfaces with texture coordinates, with different names; may be empty. GLB contains the
    /// images; USDA and the material library that is written next to OBJ (.mtl) refer to them; PLY and STL
    /// have no materials.
    std::vector<MaterialFiles> materials;
    /// The index in `materials` of each face; empty: all faces have the first material. GLB has a primitive
    /// for each material with faces, USDA a subset of the faces (`materialBind`), OBJ `usemtl` before each
    /// run of faces; materials without faces are not written.
    std::span<const std::uint32_t> face_materials;
    /// Placed copies, such as leaves; may be empty. GLB: a node for each prototype, with
    /// EXT_mesh_gpu_instancing if they are not merged. USDA: a point instancer. OBJ, PLY and STL: merged
    /// copies, in OBJ a group for each prototype. PLY and STL have no materials and no colours of copies.
    InstancedParts parts = {};
};

/// Writes a surface atomically (`AtomicFile`).
///
/// * OBJ, PLY, USDA: faces unchanged. PLY is binary little endian; texture coordinates are s and t.
/// * STL, GLB: triangles; quads are split along their shorter diagonal, larger faces become fans.
/// * GLB: Y up, smooth normals, a plain brown material, and for normal maps the tangents of [Mikkelsen2008];
/// passes the Khronos validator.
/// * USDA: Z up, metres, subdivisionScheme "none", smooth normals.
///
/// Text formats write the shortest digits that restore the same number. OBJ and PLY (then with doubles) add
/// the origin in double precision; GLB and USDA store it as the translation of the node; STL rounds the sum,
/// and different vertices keep different positions, so that a closed surface is read back as closed.
///
/// The result does not depend on the number of threads. Cost: 1.8 million quads on two idle cores took 0.07 s
/// as PLY and 0.23 s as OBJ; memory is below 32 MiB, plus 12 bytes per vertex if normals are written.
///
/// Throws `IoError` if the file cannot be written; `Unsupported` for an unknown extension, for OFF, and for a
/// mesh that the format cannot represent (GLB: more than 4 GiB; STL: rounding of more than 1e-5 of the size);
/// `InvalidInput` for a mesh without faces, for coordinates that are not finite, and for invalid instances,
/// materials or names of `parts`; `Cancelled`. Indices must
/// be in range.
void write_mesh(const std::filesystem::path& path, const QuadMesh& mesh, const MeshWriteOptions& options = {},
                const Context& ctx = {});
/// Writes a triangle mesh.
void write_mesh(const std::filesystem::path& path, const TriMesh& mesh, const MeshWriteOptions& options = {},
                const Context& ctx = {});
/// Writes faces with any number of corners.
void write_mesh(const std::filesystem::path& path, const PolygonMesh& mesh,
                const MeshWriteOptions& options = {}, const Context& ctx = {});

/// Writes a control cage as USDA with subdivisionScheme "catmullClark", so that the importing program refines
/// it. Throws as above.
void write_cage(const std::filesystem::path& path, const QuadMesh& cage, const Context& ctx = {});

}  // namespace coppice
