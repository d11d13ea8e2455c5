#pragma once

#include <array>
#include <filesystem>
#include <optional>
#include <string_view>

#include "coppice/base/fields.h"

namespace coppice {

/// The kinds of file that hold a skeleton; docs/user/formats.md describes each.
enum class SkeletonFormat {
    automatic,  ///< told by the name and the content
    swc,        ///< SWC: id type x y z radius parent
    cylinders,  ///< a table of cylinders as text: TreeQSM, SimpleForest, aRchi, arbor, treegraph
    mat,        ///< TreeQSM's MATLAB files; read only
    raycloud,   ///< raycloudtools' tree file; read only
    ply,        ///< PLY with vertices and edges, as AdTree writes it
    gel,        ///< GEL's graph: nodes and connections without radii; read only
    obj,        ///< OBJ with line elements
    json,       ///< Coppice's own; treegraph's is read
    rsml,       ///< RSML: the root systems of RootSystemML
    mtg         ///< MTG: OpenAlea's multi-scale tree graphs
};

template <>
struct EnumNames<SkeletonFormat> {
    static constexpr std::array<std::string_view, 11> names{
        "automatic", "swc", "cylinders", "mat", "raycloud", "ply", "gel", "obj", "json", "rsml", "mtg"};
};

/// The format that the ending of a file's name stands for, in any case; none when it stands for none, or for
/// several as
/// ".txt" does. ".csv" is `cylinders`.
std::optional<SkeletonFormat> format_of_extension(const std::filesystem::path& path);

/// The format of a file by its first bytes and lines; none when they look like none. Rows of numbers without
/// names are nodes of SWC, or cylinders, only where they are linked as those are: else they may be points.
/// The content may be the beginning of the file.
std::optional<SkeletonFormat> format_of_content(std::string_view content);

}  // namespace coppice
