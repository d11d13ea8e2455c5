#include "coppice/io/skeleton_format.h"

#include <algorithm>
#include <string>
#include <vector>

#include "coppice/io/ply_header.h"
#include "coppice/io/skeleton_parsers_internal.h"
#include "coppice/io/text_internal.h"

namespace coppice {

namespace {

bool is_matlab(std::string_view content) {
    return content.starts_with("MATLAB ") || content.starts_with("\x89HDF\r\n\x1a\n");
}

bool all_numbers(const std::vector<std::string_view>& cells) {
    return std::all_of(cells.begin(), cells.end(),
                       [](std::string_view cell) { return parse_number(cell).has_value(); });
}

/// The format of a text by its first line that is neither empty nor a comment.
std::optional<SkeletonFormat> format_of_line(std::string_view line) {
    std::vector<std::string_view> words;
    split_at_blanks(line, words);
    const std::string_view first = words[0];
    if (first == "v" || first == "l" || first == "o" || first == "g" || first == "mtllib")
        return SkeletonFormat::obj;
    if (first == "n" && words.size() >= 4) return SkeletonFormat::gel;
    if (words.size() == 7 && all_numbers(words)) return SkeletonFormat::swc;
    if (is_raycloud_header(line)) return SkeletonFormat::raycloud;
    if (is_cylinder_header(line)) return SkeletonFormat::cylinders;
    split_at_blanks(line, words, true);
    if (words.size() >= kLeastHeaderlessColumns && all_numbers(words)) return SkeletonFormat::cylinders;
    return std::nullopt;
}

}  // namespace

std::optional<SkeletonFormat> format_of_extension(const std::filesystem::path& path) {
    struct Entry {
        std::string_view extension;
        SkeletonFormat format;
    };
    constexpr std::array<Entry, 8> kEntries{{{"swc", SkeletonFormat::swc},
                                             {"csv", SkeletonFormat::cylinders},
                                             {"mat", SkeletonFormat::mat},
                                             {"ply", SkeletonFormat::ply},
                                             {"graph", SkeletonFormat::gel},
                                             {"gel", SkeletonFormat::gel},
                                             {"obj", SkeletonFormat::obj},
                                             {"json", SkeletonFormat::json}}};
    const std::string extension = plain_name(path.extension().string());
    for (const Entry& entry : kEntries) {
        if (entry.extension == extension) return entry.format;
    }
    return std::nullopt;
}

std::optional<SkeletonFormat> format_of_content(std::string_view content) {
    if (is_ply(content)) return SkeletonFormat::ply;
    if (is_matlab(content)) return SkeletonFormat::mat;
    LineReader lines(content);
    while (lines.next()) {
        const std::string_view line = trimmed(lines.line());
        if (line.empty() || line[0] == '#') continue;
        if (line[0] == '{') return SkeletonFormat::json;
        return format_of_line(line);
    }
    return std::nullopt;
}

}  // namespace coppice
