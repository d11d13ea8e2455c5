#include "coppice/io_mesh/format.h"

#include <algorithm>
#include <array>
#include <cstdint>
#include <cstring>
#include <string>
#include <utility>

#include "coppice/base/ascii.h"

namespace coppice {
namespace {

constexpr std::string_view kBlanks = " \t\r\n";

std::string_view first_word(std::string_view text) {
    text.remove_prefix(std::min(text.find_first_not_of(kBlanks), text.size()));
    return text.substr(0, text.find_first_of(kBlanks));
}

/// Returns whether the size of the file fits an 80-byte header, a count and 50 bytes for each triangle.
bool is_binary_stl(std::string_view bytes) {
    if (bytes.size() < 84) return false;
    std::uint32_t count = 0;
    std::memcpy(&count, bytes.data() + 80, sizeof count);
    return bytes.size() == 84 + std::uint64_t{50} * count;
}

bool is_off_keyword(std::string_view word) {
    for (const std::string_view prefix : {"ST", "C", "N", "4", "n"}) {
        if (word.starts_with(prefix)) word.remove_prefix(prefix.size());
    }
    return word == "OFF";
}

}  // namespace

std::optional<MeshFormat> mesh_format_of_name(const std::filesystem::path& path) {
    const std::string extension = to_lower(path.extension().string());
    constexpr std::array<std::pair<std::string_view, MeshFormat>, 6> kNames{{{".obj", MeshFormat::obj},
                                                                             {".ply", MeshFormat::ply},
                                                                             {".off", MeshFormat::off},
                                                                             {".stl", MeshFormat::stl},
                                                                             {".glb", MeshFormat::glb},
                                                                             {".usda", MeshFormat::usda}}};
    for (const auto& [name, format] : kNames) {
        if (extension == name) return format;
    }
    return {};
}

std::optional<MeshFormat> mesh_format_of_content(std::string_view bytes) {
    if (bytes.starts_with("glTF")) return MeshFormat::glb;
    if (bytes.starts_with("#usda")) return MeshFormat::usda;
    if (is_binary_stl(bytes)) return MeshFormat::stl;
    const std::string_view word = first_word(bytes.substr(0, 256));
    if (word == "ply") return MeshFormat::ply;
    if (word == "solid") return MeshFormat::stl;
    if (is_off_keyword(word)) return MeshFormat::off;
    return {};
}

}  // namespace coppice
