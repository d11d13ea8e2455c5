#include "files.h"

#include <fmt/format.h>

#include <algorithm>
#include <cctype>
#include <fstream>

#include "coppice/io/mesh/format.h"
#include "coppice/io/mesh/reader.h"
#include "coppice/io/points/reader.h"
#include "options.h"

namespace coppice::cli {
namespace {

constexpr std::size_t kHeadSize = 64 * 1024;

std::string ending_of(const std::filesystem::path& path) {
    std::string ending = path.extension().string();
    std::ranges::transform(ending, ending.begin(),
                           [](unsigned char c) { return static_cast<char>(std::tolower(c)); });
    return ending;
}

std::string head_of(const std::filesystem::path& path) {
    std::string head(kHeadSize, '\0');
    std::ifstream file(path, std::ios::binary);
    file.read(head.data(), static_cast<std::streamsize>(head.size()));
    head.resize(static_cast<std::size_t>(std::max<std::streamsize>(0, file.gcount())));
    return head;
}

/// Whether the first element of an OBJ file is a line; long lists of vertices come before it.
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

FileKind kind_of_ply(const std::filesystem::path& path) {
    const std::string head = head_of(path);
    const std::string_view header = std::string_view(head).substr(0, head.find("end_header"));
    const auto has = [&](std::string_view text) { return header.find(text) != header.npos; };
    const bool faces = has("element face") && !has("element face 0\n") && !has("element face 0\r");
    if (faces || has("element tristrips") || !has("element vertex")) return FileKind::mesh;
    return has("element edge") ? FileKind::skeleton : FileKind::points;
}

bool is_one_of(const std::string& ending, std::initializer_list<std::string_view> endings) {
    return std::ranges::find(endings, ending) != endings.end();
}

}  // namespace

FileKind kind_of_input(const std::filesystem::path& path) {
    const std::string ending = ending_of(path);
    std::error_code error;
    const bool readable = std::filesystem::is_regular_file(path, error);
    if (readable && ending == ".obj") return obj_holds_lines(path) ? FileKind::skeleton : FileKind::mesh;
    if (readable && ending == ".ply") return kind_of_ply(path);
    if (is_one_of(ending, {".xyz", ".asc", ".pcd", ".las", ".laz"})) return FileKind::points;
    if (readable && is_one_of(ending, {".txt", ".csv"}))
        return format_of_content(head_of(path)) ? FileKind::skeleton : FileKind::points;
    if (mesh_format_of_name(path)) return FileKind::mesh;
    if (format_of_extension(path) || !readable) return FileKind::skeleton;
    return mesh_format_of_content(head_of(path)) ? FileKind::mesh : FileKind::skeleton;
}

FileKind kind_of_output(const std::filesystem::path& path, FileKind preferred) {
    const bool mesh = mesh_format_of_name(path).has_value(), skeleton = format_of_extension(path).has_value();
    if (mesh && skeleton) return preferred;
    if (mesh || skeleton) return mesh ? FileKind::mesh : FileKind::skeleton;
    throw UsageError(
        fmt::format("the ending of '{}' names no format; use .obj, .ply, .stl, .glb or .usda for a mesh, "
                    ".swc, .json, .obj, .ply or "
                    ".csv for a skeleton",
                    path.string()));
}

void check_output_folder(const std::filesystem::path& path) {
    const std::filesystem::path folder = path.has_parent_path() ? path.parent_path() : ".";
    std::error_code error;
    if (std::filesystem::is_directory(folder, error)) return;
    throw IoError(
        fmt::format("cannot write '{}': the folder '{}' does not exist", path.string(), folder.string()));
}

void check_mesh_output(const std::filesystem::path& path) {
    const auto format = mesh_format_of_name(path);
    if (!format || *format == MeshFormat::off) {
        throw UsageError(fmt::format(
            "'{}' is no name of a mesh; use the ending .obj, .ply, .stl, .glb or .usda", path.string()));
    }
    check_output_folder(path);
}

void check_points_output(const std::filesystem::path& path) {
    if (!point_format_of_name(path)) {
        throw UsageError(fmt::format(
            "'{}' is no name of points; use the ending .ply, .xyz, .txt, .asc or .csv", path.string()));
    }
    check_output_folder(path);
}

Figures repairs_of(const RepairReport& r) {
    Figures out;
    out["reordered"] = r.reordered;
    out["missing_parents"] = r.missing_parents;
    out["missing_radii"] = r.missing_radii;
    out["zero_length"] = r.zero_length;
    out["coincident"] = r.coincident;
    out["bridged_gaps"] = r.bridged_gaps;
    out["attached_inside"] = r.attached_inside;
    out["radius_jumps"] = r.radius_jumps;
    return out;
}

SkeletonFile load_skeleton(Run& run, const std::filesystem::path& path, const ReadSkeletonOptions& options) {
    SkeletonFile file =
        run.stage("read", [&](const Context& ctx) { return read_skeleton(path, options, ctx); });
    run.counts()["nodes"] = file.skeleton.size();
    run.counts()["trees"] = file.skeleton.tree_count();
    run.repairs() = repairs_of(file.report);
    return file;
}

PolygonMesh load_mesh(Run& run, const std::filesystem::path& path) {
    PolygonMesh mesh = run.stage("read", [&](const Context& ctx) { return read_mesh(path, ctx); });
    run.counts()["vertices"] = mesh.positions.size();
    run.counts()["faces"] = mesh.face_count();
    return mesh;
}

PointSet load_points(Run& run, const std::filesystem::path& path) {
    PointSet points = run.stage("read", [&](const Context& ctx) { return read_points(path, ctx); });
    run.counts()["points"] = points.size();
    return points;
}

}  // namespace coppice::cli
