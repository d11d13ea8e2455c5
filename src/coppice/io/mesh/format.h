#pragma once

#include <filesystem>
#include <optional>
#include <string_view>

namespace coppice {

/// The mesh files that are known; see docs/user/meshes.md for what each keeps.
enum class MeshFormat {
    obj,   ///< text, faces of any size
    ply,   ///< written binary little endian; read in all three encodings
    off,   ///< text; read only
    stl,   ///< triangles without shared vertices; written binary, read in both encodings
    glb,   ///< binary glTF 2.0: triangles, Y up
    usda,  ///< OpenUSD text; written only
};

/// By the last extension of the name, upper or lower case; nothing when it belongs to no mesh format.
std::optional<MeshFormat> mesh_format_of_name(const std::filesystem::path& path);

/// By the first bytes of a file; nothing when they do not tell (an OBJ file has no mark of its own).
std::optional<MeshFormat> mesh_format_of_content(std::string_view bytes);

}  // namespace coppice
