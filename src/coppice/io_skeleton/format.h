#pragma once

#include <array>
#include <filesystem>
#include <optional>
#include <string_view>

#include "coppice/base/fields.h"

namespace coppice {

/// Skeleton file formats; docs/user/formats.md describes each.
enum class SkeletonFormat {
    automatic,  ///< detected by name and content
    swc,        ///< SWC: id type x y z radius parent
    cylinders,  ///< a table of cylinders as text: TreeQSM, SimpleForest, aRchi, arbor, treegraph
    mat,        ///< MATLAB files of TreeQSM; read only
    raycloud,   ///< tree file of raycloudtools; read only
    ply,        ///< PLY with vertices and edges, as written by AdTree
    gel,        ///< graph of GEL: nodes and connections without radii; read only
    obj,        ///< OBJ with line elements
    json,       ///< format of Coppice; reads that of treegraph too
    rsml,       ///< RSML: root systems of RootSystemML
    mtg         ///< MTG: multi-scale tree graphs of OpenAlea
};

template <>
struct EnumNames<SkeletonFormat> {
    static constexpr std::array<std::string_view, 11> names{
        "automatic", "swc", "cylinders", "mat", "raycloud", "ply", "gel", "obj", "json", "rsml", "mtg"};
};

/// Returns the format by the extension of the name, case-insensitively; nullopt if it is unknown or
/// ambiguous, like ".txt". ".csv" is `cylinders`.
std::optional<SkeletonFormat> format_of_extension(const std::filesystem::path& path);

/// Returns the format by the first bytes and lines; nullopt if it is unknown. Rows of numbers without names
/// are nodes of SWC, or cylinders, only if they are linked accordingly: otherwise they may be points. The
/// content may be only the beginning of the file.
std::optional<SkeletonFormat> format_of_content(std::string_view content);

}  // namespace coppice
