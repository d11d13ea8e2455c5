#include "coppice/scene/file_kind.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <fstream>
#include <string>
#include <string_view>

#include "coppice/base/ascii.h"
#include "coppice/base/error.h"
#include "coppice/io/text.h"
#include "coppice/io/unread_format.h"
#include "coppice/io_mesh/format.h"
#include "coppice/io_skeleton/format.h"
#include "coppice/system/file.h"

namespace coppice {
namespace {

constexpr std::size_t kHeadSize = 64 * 1024;

std::string get_ending(const std::filesystem::path& path) { return to_lower(path.extension().string()); }

std::string read_head(const std::filesystem::path& path) {
    std::string head(kHeadSize, '\0');
    std::ifstream file(path, std::ios::binary);
    file.read(head.data(), static_cast<std::streamsize>(head.size()));
    head.resize(static_cast<std::size_t>(std::max<std::streamsize>(0, file.gcount())));
    return head;
}

/// Returns whether the first element after the vertices of an OBJ file is a line.
bool obj_holds_lines(const std::filesystem::path& path) {
    std::ifstream file(path, std::ios::binary);
    std::string chunk(1 << 20, '\0');
    char previous = '\n', before = '\0';
    while (file.read(chunk.data(), static_cast<std::streamsize>(chunk.size())), file.gcount() > 0) {
        for (const char c : std::string_view(chunk.data(), static_cast<std::size_t>(file.gcount()))) {
            const bool blank = c == ' ' || c == '\t';
            if (blank && before == '\n' && (previous == 'f' || previous == 'l')) return previous == 'l';
            before = previous;
            previous = c;
        }
    }
    return false;
}

FileKind kind_of_ply(const std::string& head) {
    const std::string_view header = std::string_view(head).substr(0, head.find("end_header"));
    const auto has = [&](std::string_view text) { return header.find(text) != header.npos; };
    const bool faces = has("element face") && !has("element face 0\n") && !has("element face 0\r");
    if (faces || has("element tristrips") || !has("element vertex")) return FileKind::mesh;
    return has("element edge") ? FileKind::skeleton : FileKind::points;
}

/// Returns whether the number of faces, the second number of an OFF file, is positive.
FileKind kind_of_off(const std::string& head) {
    LineReader lines(head);
    std::vector<std::string_view> words, numbers;
    while (numbers.size() < 2 && lines.next()) {
        split_at_blanks(lines.line().substr(0, lines.line().find('#')), words);
        for (const std::string_view word : words)
            if (parse_integer(word)) numbers.push_back(word);
    }
    return numbers.size() >= 2 && parse_integer(numbers[1]) == 0 ? FileKind::points : FileKind::mesh;
}

bool is_one_of(const std::string& ending, std::initializer_list<std::string_view> endings) {
    return std::ranges::find(endings, ending) != endings.end();
}

std::optional<FileKind> kind_of_name(const std::filesystem::path& path) {
    const std::string ending = get_ending(path);
    if (is_one_of(ending, {".xyz", ".asc", ".pts", ".ptx", ".pcd", ".las", ".laz", ".e57"}))
        return FileKind::points;
    if (mesh_format_of_name(path)) return FileKind::mesh;
    if (format_of_extension(path)) return FileKind::skeleton;
    return {};
}

std::optional<FileKind> kind_of_content(const std::string& head) {
    const auto mesh = mesh_format_of_content(head);
    if (mesh == MeshFormat::ply) return kind_of_ply(head);
    if (mesh == MeshFormat::off) return kind_of_off(head);
    if (mesh) return FileKind::mesh;
    if (head.starts_with("LASF") || head.starts_with("# .PCD") || head.starts_with("ASTM-E57"))
        return FileKind::points;
    if (format_of_content(head)) return FileKind::skeleton;
    return {};
}

}  // namespace

std::optional<FileKind> kind_of_file(const std::filesystem::path& path) {
    const std::string ending = get_ending(path);
    std::error_code error;
    if (!std::filesystem::is_regular_file(path, error)) {
        if (!std::filesystem::exists(path, error)) read_file(path);  // throws with the reason
        return kind_of_name(path);
    }
    const std::string head = read_head(path);
    if (const auto unread = unread_format(head); unread && ending != ".mat")
        throw Unsupported(fmt::format("{}: it is {}", path.string(), *unread));
    if (ending == ".obj") return obj_holds_lines(path) ? FileKind::skeleton : FileKind::mesh;
    if (ending == ".ply") return kind_of_ply(head);
    if (ending == ".off") return kind_of_off(head);
    if (is_one_of(ending, {".txt", ".csv"})) {
        return format_of_content(head) ? FileKind::skeleton : FileKind::points;
    }
    if (const auto kind = kind_of_name(path)) return kind;
    return kind_of_content(head);
}

std::optional<FileKind> kind_of_output(const std::filesystem::path& path, FileKind preferred) {
    const bool mesh = mesh_format_of_name(path).has_value(), skeleton = format_of_extension(path).has_value();
    if (mesh && skeleton) return preferred;
    if (mesh || skeleton) return mesh ? FileKind::mesh : FileKind::skeleton;
    return {};
}

}  // namespace coppice
