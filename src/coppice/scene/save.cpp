#include "coppice/scene/save.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>

#include "coppice/base/quote.h"
#include "coppice/io_mesh/writer.h"
#include "coppice/io_points/reader.h"
#include "coppice/io_points/writer.h"
#include "coppice/io_skeleton/writer.h"

namespace coppice {
namespace {

bool is_writable(SkeletonFormat format) {
    return format == SkeletonFormat::swc || format == SkeletonFormat::cylinders ||
           format == SkeletonFormat::ply || format == SkeletonFormat::obj || format == SkeletonFormat::json ||
           format == SkeletonFormat::rsml || format == SkeletonFormat::mtg;
}

bool suits(ObjectKind kind, const std::filesystem::path& path) {
    if (kind == ObjectKind::points) return point_format_of_name(path).has_value();
    if (kind == ObjectKind::skeleton) {
        const auto format = format_of_extension(path);
        return format && is_writable(*format);
    }
    if (kind == ObjectKind::mesh) {
        const auto format = mesh_format_of_name(path);
        return format && *format != MeshFormat::off;
    }
    return false;
}

std::string_view find_hint(ObjectKind kind) {
    switch (kind) {
        case ObjectKind::points:
            return "use .las, .ply, .xyz, .txt, .csv or .asc";
        case ObjectKind::skeleton:
            return "use .swc, .json, .csv, .ply, .obj, .rsml or .mtg";
        case ObjectKind::mesh:
            return "use .obj, .ply, .glb, .stl or .usda";
        case ObjectKind::solid:
            return "write the mesh that polygonize creates from it";
        case ObjectKind::path:
        case ObjectKind::profile:
        case ObjectKind::material:
            break;
    }
    return "it is saved by: save recipe FILE.coppice";
}

/// Escapes ${ in a line, because the name of a file may contain it.
std::string without_variables(std::string_view line) {
    std::string out;
    for (std::size_t i = 0; i < line.size(); ++i) {
        if (line.substr(i).starts_with("${")) out += '$';
        out += line[i];
    }
    return out;
}

[[noreturn]] void refuse_to_hold(const std::filesystem::path& path) {
    throw InvalidInput(fmt::format("the scene makes no object that '{}' can store", path.string()));
}

}  // namespace

ObjectPtr object_for_file(const SceneState& state, const std::string& name,
                          const std::filesystem::path& path) {
    std::vector<ObjectKind> fitting;
    ObjectPtr last;
    for (const auto& key : state.made) {
        const auto found = state.objects.find(key);
        if (found == state.objects.end() || !suits(key.first, path)) continue;
        if (!name.empty() && key.second != name) continue;
        if (std::ranges::find(fitting, key.first) == fitting.end()) fitting.push_back(key.first);
        last = found->second;
    }
    if (!last && name.empty()) refuse_to_hold(path);
    if (!last) {
        const auto same =
            std::ranges::find_if(state.objects, [&](const auto& o) { return o.first.second == name; });
        COPPICE_ASSERT(same != state.objects.end());
        check_file_name(*same->second, path);
    }
    if (!name.empty() && fitting.size() > 1) {
        throw InvalidInput(
            fmt::format("{} is the name of several objects that '{}' can store; add kind= and one of {}, {}",
                        quote(name), path.string(), name_of(fitting[0]), name_of(fitting[1])));
    }
    return last;
}

void check_scene_output(std::span<const SceneCommand* const> commands, const std::filesystem::path& path) {
    constexpr std::array kWritten{ObjectKind::mesh, ObjectKind::skeleton, ObjectKind::points};
    if (std::ranges::none_of(kWritten, [&](ObjectKind kind) { return suits(kind, path); })) {
        throw InvalidInput(fmt::format(
            "the extension of '{}' is not a known format; for a mesh {}, for a skeleton {}, for points {}",
            path.string(), find_hint(ObjectKind::mesh), find_hint(ObjectKind::skeleton),
            find_hint(ObjectKind::points)));
    }
    const bool made = std::ranges::any_of(
        commands, [&](const SceneCommand* c) { return c->makes && suits(*c->makes, path); });
    if (!made) refuse_to_hold(path);
}

void check_file_name(const SceneObject& object, const std::filesystem::path& path) {
    const ObjectKind kind = object.kind();
    if (suits(kind, path)) return;
    throw InvalidInput(fmt::format("'{}' is not a valid file name for {}; {}", path.string(),
                                   with_article(kind), find_hint(kind)));
}

void save_object(const SceneObject& object, const std::filesystem::path& path, InstanceStorage storage,
                 const Context& ctx) {
    check_file_name(object, path);
    if (const auto* points = std::get_if<PointSet>(&object.value)) {
        write_points(path, *points, ctx);
    } else if (const auto* skeleton = std::get_if<Skeleton>(&object.value)) {
        write_skeleton(path, *skeleton, {}, object.attributes, ctx);
    } else {
        const auto& surface = std::get<Surface>(object.value);
        MeshWriteOptions options{.texture = surface.texture,
                                 .texture_blends = surface.texture_blends,
                                 .materials = write_images(surface.materials, path, ctx),
                                 .face_materials = surface.slots};
        if (surface.leaves) options.parts = surface.leaves->parts(storage);
        std::visit([&](const auto& mesh) { write_mesh(path, mesh, options, ctx); }, surface.mesh);
    }
}

std::string make_recipe(const SceneState& state) {
    std::string text = "# Makes the same objects as the original scene; every option is spelled out.\n";
    for (const std::string& line : state.history) text += without_variables(line) + "\n";
    return text;
}

}  // namespace coppice
