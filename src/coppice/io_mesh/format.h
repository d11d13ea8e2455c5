#pragma once

#include <filesystem>
#include <optional>
#include <string_view>

namespace coppice {

/// Supported mesh formats; docs/user/meshes.md lists the data that each stores.
enum class MeshFormat {
    obj,   ///< text; faces of any number of corners
    ply,   ///< written binary little endian; read in all three encodings
    off,   ///< text; read only
    stl,   ///< triangles without shared vertices; written binary, read in both encodings
    glb,   ///< binary glTF 2.0: triangles, Y up
    usda,  ///< OpenUSD text; written only
};

/// Returns the format by the extension of the name, case-insensitively; nullopt if it is not a mesh format.
std::optional<MeshFormat> mesh_format_of_name(const std::filesystem::path& path);

/// Returns the format by the first bytes of a file; nullopt if they are not sufficient (OBJ has no
/// signature).
std::optional<MeshFormat> mesh_format_of_content(std::string_view bytes);

}  // namespace coppice
