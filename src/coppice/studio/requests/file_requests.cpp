#include <fmt/format.h>

#include <algorithm>
#include <filesystem>
#include <system_error>

#include "coppice/base/error.h"
#include "coppice/io_database/tree_library.h"
#include "coppice/options/quantity.h"
#include "coppice/scene/save.h"
#include "coppice/scene/words.h"
#include "coppice/studio/session_internal.h"
#include "coppice/system/file.h"

namespace coppice::studio_internal {

std::filesystem::path path_to_write(const Studio& studio, const Request& request, const std::string& name) {
    std::filesystem::path path = studio.sandbox().to_write(name);
    std::error_code ignored;
    if (!request.flag("overwrite") && std::filesystem::exists(path, ignored))
        throw IoError(
            fmt::format("'{}' already exists; allow it to be replaced, or choose another name", name));
    return path;
}

namespace {

constexpr std::size_t kMaxFiles = 5000;
constexpr int kDeepest = 4;  // maximum depth of listed folders

Json files(Studio& studio, const Request& request) {
    namespace fs = std::filesystem;
    const std::string ending = request.text("ending", "");
    const fs::path folder = studio.sandbox().folder();
    std::vector<std::pair<std::string, std::uintmax_t>> found;
    std::error_code error;
    fs::recursive_directory_iterator at(folder, fs::directory_options::skip_permission_denied, error);
    for (; !error && at != fs::recursive_directory_iterator() && found.size() < kMaxFiles;
         at.increment(error)) {
        const std::string name = at->path().lexically_relative(folder).generic_string();
        const bool hidden = at->path().filename().string().starts_with('.');
        if (at->is_symlink(error) || hidden || at.depth() >= kDeepest) at.disable_recursion_pending();
        if (hidden || at->is_symlink(error) || !at->is_regular_file(error) || !name.ends_with(ending))
            continue;
        found.emplace_back(name, at->file_size(error));
    }
    std::ranges::sort(found);
    Json out = Json::array();
    for (const auto& [name, bytes] : found) out.push_back({{"name", name}, {"bytes", bytes}});
    return {{"files", out}};
}

Json open(Studio& studio, const Request& request) {
    const std::string& name = request.text("file");
    studio.previewed.clear();
    std::string text;
    if (!name.empty()) text = read_file(studio.sandbox().to_read(name), kLongestLine * 16, request.ctx);
    studio.document.open(text, name, request.ctx);
    studio.note_saved();
    return Json::object();
}

Json save(Studio& studio, const Request& request) {
    const std::string name = request.text("file", studio.document.file().c_str());
    if (name.empty()) throw InvalidInput("specify a name for the scene, such as tree.coppice");
    const bool own = name == studio.document.file();
    const std::filesystem::path path =
        own ? studio.sandbox().to_write(name) : path_to_write(studio, request, name);
    write_file(path, studio.document.text());
    studio.document.call(name);
    studio.note_saved();
    studio.recovered = false;
    ++studio.saves;
    return written(path, name);
}

bool holds_mesh(const std::filesystem::path& path) {
    std::string ending = path.extension().string();
    std::ranges::transform(ending, ending.begin(), [](unsigned char c) { return std::tolower(c); });
    constexpr std::array<std::string_view, 7> kMeshes{".glb", ".ply",  ".obj", ".stl",
                                                      ".off", ".usda", ".gltf"};
    return std::ranges::find(kMeshes, ending) != kMeshes.end();
}

/// Content of the file: the skeleton itself, or its surface.
std::optional<bool> wants_surface(const Request& request) {
    const std::string as = request.text("as", "");
    if (as.empty()) return std::nullopt;
    if (as != "skeleton" && as != "surface") throw InvalidInput("'as' must be skeleton or surface");
    return as == "surface";
}

/// Writes an object; of a skeleton or solid its surface, if the format is for meshes.
Json export_object(Studio& studio, const Request& request) {
    const std::string& file = request.text("file");
    const ExportRequest export_request{.kind = request.kind(),
                                       .name = request.text("name"),
                                       .path = path_to_write(studio, request, file),
                                       .as_surface = wants_surface(request),
                                       .surface = surface_options(request)};
    const ObjectCount count = count_elements(*export_to(studio, export_request, request.ctx));
    Json out = written(export_request.path, file);
    out["count"] = count.count;
    out["unit"] = count.unit;
    return out;
}

/// Lists the branches of a library by their numbers and measures.
Json library(Studio& studio, const Request& request) {
    const TreeLibrary library(studio.sandbox().to_read(request.text("file")), LibraryAccess::read,
                              request.ctx);
    Json out = Json::array();
    for (const LibraryEntry& entry : library.list({})) {
        out.push_back({{"number", entry.id},
                       {"source", entry.source},
                       {"tags", entry.tags},
                       {"leads", entry.tree.leads},
                       {"length", entry.measures.length},
                       {"volume", entry.measures.volume},
                       {"extent", entry.measures.extent},
                       {"nodes", entry.measures.nodes},
                       {"tips", entry.measures.tips},
                       {"orders", entry.measures.orders},
                       {"radius", entry.measures.radius}});
    }
    return {{"branches", out}};
}

/// Returns the skeleton of one branch.
Json branch(Studio& studio, const Request& request) {
    const TreeLibrary library(studio.sandbox().to_read(request.text("file")), LibraryAccess::read,
                              request.ctx);
    LibraryFilter filter;
    filter.ids.push_back(fmt::format("{}", request.count("number", 0)));
    std::vector<LibraryEntry> found = library.read(filter);
    if (found.empty()) throw InvalidInput(fmt::format("the library has no tree {}", filter.ids.front()));
    const SceneObject object{std::move(found.front().tree.skeleton), 0};
    const GeometryHead head{ObjectKind::skeleton, filter.ids.front(), 0, {}};
    return {{"key", studio.blobs.offer(encode_object(object, head, 1, StudioColor::plain, request.ctx))}};
}

}  // namespace

Json written(const std::filesystem::path& path, const std::string& name) {
    std::error_code ignored;
    return {{"file", name}, {"bytes", std::filesystem::file_size(path, ignored)}};
}

std::string typed_options(const Request& request, const char* field) {
    std::string out;
    const auto found = request.fields.find(field);
    if (found == request.fields.end() || !found->is_object()) return out;
    for (const auto& [name, value] : found->items()) {
        const bool good = !name.empty() && std::ranges::all_of(name, [](char c) {
            return (c >= 'a' && c <= 'z') || (c >= '0' && c <= '9') || c == '_';
        });
        if (!good) throw InvalidInput(fmt::format("'{}' is not the name of an option", name.substr(0, 40)));
        out += fmt::format(" {}={}", name,
                           quoted_word(value.is_string() ? value.get<std::string>() : value.dump()));
    }
    return out;
}

ObjectPtr make_surface(const Studio& studio, const Document::Name& object, const std::string& options,
                       const Context& ctx) {
    ObjectPtr itself = studio.object(object.first, object.second);
    const bool tree = object.first == ObjectKind::skeleton;
    if (!tree && object.first != ObjectKind::solid) return itself;
    Scene scene = studio.document.scene();
    const std::string command = tree ? "mesh" : "polygonize", name = quoted_word(object.second);
    scene.run(fmt::format("{} {} {}{}", command, name, name, tree ? options : ""), {}, ctx);
    return scene.state().objects.at({ObjectKind::mesh, object.second});
}

ObjectPtr export_to(const Studio& studio, const ExportRequest& export_request, const Context& ctx) {
    const bool as_surface = export_request.kind == ObjectKind::solid ||
                            (export_request.kind == ObjectKind::skeleton &&
                             export_request.as_surface.value_or(holds_mesh(export_request.path)));
    ObjectPtr object = as_surface ? make_surface(studio, {export_request.kind, export_request.name},
                                                 export_request.surface, ctx)
                                  : studio.object(export_request.kind, export_request.name);
    save_object(*object, export_request.path, ctx);
    return object;
}

std::map<std::string, Handler> file_requests() {
    return {{"files", files},          {"open", open},       {"save", save},
            {"export", export_object}, {"library", library}, {"branch", branch}};
}

}  // namespace coppice::studio_internal
