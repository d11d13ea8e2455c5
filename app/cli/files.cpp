#include "files.h"

#include <fmt/format.h>

#include <algorithm>
#include <string>

#include "coppice/io_mesh/format.h"
#include "coppice/io_points/writer.h"
#include "coppice/io_sketch/sketch_file.h"
#include "coppice/points/spacing.h"
#include "held_objects.h"
#include "options.h"

namespace coppice::cli {
namespace {

const HeldObject* find_held(const Run& run, const std::filesystem::path& path) {
    const HeldObjects* const objects = run.host().held_objects();
    if (objects == nullptr || !HeldObjects::is_name(path)) return nullptr;
    if (const HeldObject* found = objects->find(path)) return found;
    throw InvalidInput(fmt::format("there is no object '{}' in memory; store it first", path.string()));
}

/// Returns the object of a name in memory; null if it names a file. Throws UsageError for an object of
/// another kind.
template <class Object>
std::shared_ptr<const Object> find_held(const Run& run, const std::filesystem::path& path) {
    const HeldObject* const held = find_held(run, path);
    if (held == nullptr) return nullptr;
    if (const auto* object = std::get_if<std::shared_ptr<const Object>>(held)) return *object;
    const FileKind wanted = std::is_same_v<Object, SkeletonFile>  ? FileKind::skeleton
                            : std::is_same_v<Object, HeldSurface> ? FileKind::mesh
                                                                  : FileKind::points;
    throw UsageError(fmt::format("{} is needed here, and '{}' is another kind of object",
                                 with_article(wanted), path.string()));
}

FileKind kind_of_held(const HeldObject& held, const std::filesystem::path& path) {
    if (std::holds_alternative<std::shared_ptr<const SkeletonFile>>(held)) return FileKind::skeleton;
    if (std::holds_alternative<std::shared_ptr<const HeldSurface>>(held)) return FileKind::mesh;
    if (std::holds_alternative<std::shared_ptr<const PointFile>>(held)) return FileKind::points;
    throw UsageError(fmt::format("'{}' is a text, and a skeleton, a mesh or a cloud of points is needed here",
                                 path.string()));
}

/// Returns a skeleton in memory. Throws UsageError for options that only apply to files.
SkeletonFile held_skeleton(const SkeletonFile& held, const ReadSkeletonOptions& options) {
    if (options.scale != 1 || options.up != FileUp::z || options.units != LengthUnit::automatic ||
        options.default_radius != 0 || options.model > 1)
        throw UsageError("options for reading do not apply to a skeleton in memory; leave them out");
    return held;
}

/// Returns the polygons of a surface in memory and its requested attributes.
MeshFile to_mesh_file(const HeldSurface& held, std::span<const std::string> attributes) {
    MeshFile out{.mesh = std::visit(
                     [](const auto& mesh) {
                         if constexpr (std::is_same_v<std::remove_cvref_t<decltype(mesh)>, PolygonMesh>)
                             return mesh;
                         else
                             return coppice::to_polygons(mesh);
                     },
                     held.mesh),
                 .attributes = {}};
    out.mesh.texture = held.texture;
    out.mesh.texture_blends = held.blends;
    for (const VertexAttribute& attribute : held.attributes)
        if (std::ranges::find(attributes, attribute.name) != attributes.end())
            out.attributes.push_back(attribute);
    return out;
}

}  // namespace

FileKind kind_of_input(const Run& run, const std::filesystem::path& path, SkeletonFormat format) {
    if (const HeldObject* held = find_held(run, path)) return kind_of_held(*held, path);
    if (format != SkeletonFormat::automatic) return FileKind::skeleton;
    const auto kind = kind_of_file(path);
    // The content of a pipe is unknown until the reader sees it.
    if (!kind && !std::filesystem::is_regular_file(path)) return FileKind::skeleton;
    if (kind) return *kind;
    if (path.extension() == ".coppice")
        throw UsageError(fmt::format("'{0}' is a scene; run it with coppice run {0} -o FILE", path.string()));
    throw UsageError(
        fmt::format("'{}' is neither a skeleton nor a mesh nor points, as far as its name and content show; "
                    "see coppice help convert",
                    path.string()));
}

std::shared_ptr<const SurfaceLeaves> find_held_leaves(const Run& run, const std::filesystem::path& path) {
    const auto surface = find_held<HeldSurface>(run, path);
    return surface ? surface->leaves : nullptr;
}

std::shared_ptr<const std::string> find_held_text(const Run& run, const std::filesystem::path& path) {
    const HeldObject* const held = find_held(run, path);
    if (held == nullptr) return nullptr;
    if (const auto* text = std::get_if<std::shared_ptr<const std::string>>(held)) return *text;
    throw UsageError(fmt::format("a text is needed here, and '{}' is another kind of object", path.string()));
}

FileKind kind_to_write(const std::filesystem::path& path, FileKind preferred) {
    if (const auto kind = kind_of_output(path, preferred)) return *kind;
    throw UsageError(
        fmt::format("the extension of '{}' is not supported; use .obj, .ply, .stl, .glb or .usda for a mesh, "
                    ".swc, .json, .obj, .ply, .csv, .rsml or .mtg for a skeleton",
                    path.string()));
}

std::filesystem::path resolved_path(const std::filesystem::path& path) {
    std::error_code error;
    auto resolved = std::filesystem::weakly_canonical(std::filesystem::absolute(path, error), error);
    return error ? std::filesystem::path() : resolved;
}

std::vector<std::filesystem::path> files_within(const std::vector<std::filesystem::path>& named) {
    namespace fs = std::filesystem;
    std::vector<fs::path> out;
    for (const fs::path& path : named) {
        std::error_code error;
        if (!fs::is_directory(path, error)) {
            out.push_back(path);
            continue;
        }
        std::vector<fs::path> within;
        fs::recursive_directory_iterator entry(path, fs::directory_options::skip_permission_denied, error);
        for (; entry != fs::recursive_directory_iterator(); entry.increment(error))
            if (entry->is_regular_file(error)) within.push_back(entry->path());
        std::ranges::sort(within);
        out.insert(out.end(), within.begin(), within.end());
    }
    return out;
}

std::optional<FileKind> find_kind(const std::filesystem::path& path) {
    try {
        return kind_of_file(path);
    } catch (const Error&) {
        return std::nullopt;
    }
}

void create_folder(const std::filesystem::path& path) {
    std::error_code error;
    std::filesystem::create_directory(path, error);
    if (error)
        throw IoError(fmt::format("cannot create the folder '{}': {}", path.string(), error.message()));
}

std::string_view with_article(FileKind kind) {
    return kind == FileKind::skeleton ? "a skeleton"
           : kind == FileKind::mesh   ? "a mesh"
                                      : "a cloud of points";
}

std::string remedy_for(const std::filesystem::path& path, FileKind kind, std::string_view wanted) {
    if (is_sketch_name(path)) {
        return fmt::format(
            "'{0}' is a sketch, not {1}; make a skeleton of it with coppice sketch {0} -o SKELETON",
            path.string(), wanted);
    }
    if (kind == FileKind::skeleton) {
        return fmt::format("'{0}' is a skeleton, not {1}; make a surface of it with coppice mesh {0} -o MESH",
                           path.string(), wanted);
    }
    return fmt::format("'{0}' is {1}, not {2}; make a skeleton of it with coppice extract {0} -o SKELETON",
                       path.string(), with_article(kind), wanted);
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
        throw UsageError(
            fmt::format("'{}' is not the name of a mesh; use the extension .obj, .ply, .stl, .glb or .usda",
                        path.string()));
    }
    check_output_folder(path);
}

void check_skeleton_output(const std::filesystem::path& path) {
    if (kind_to_write(path, FileKind::skeleton) != FileKind::skeleton) {
        throw UsageError(fmt::format(
            "'{}' is not the name of a skeleton; use .swc, .json, .csv, .ply, .obj, .rsml or .mtg",
            path.string()));
    }
    check_output_folder(path);
}

void check_points_output(const std::filesystem::path& path) {
    if (!point_format_of_name(path)) {
        throw UsageError(fmt::format("'{}' is not the name of a point file; {}", path.string(),
                                     remedy_for_points_name(path)));
    }
    check_output_folder(path);
}

void check_cloud_output(const std::filesystem::path& path) {
    check_points_output(path);
    if (!keeps_columns(path))
        throw UsageError(fmt::format(
            "'{}' would store only the coordinates of the points; use .las, .ply, .txt, .csv or .asc",
            path.string()));
}

std::string in_unit(std::string_view name, LengthUnit unit, int power) {
    return fmt::format("{}_{}{}", name, name_of(unit), power == 1 ? "" : std::to_string(power));
}

FigureName names_in(LengthUnit unit) {
    return [unit](std::string_view name, int power) { return in_unit(name, unit, power); };
}

void check_units(std::optional<LengthUnit>& before, const std::string& path, LengthUnit unit) {
    if (before && *before != unit)
        throw UsageError(fmt::format("'{}' is in {}, but the files before it in {}; specify --units for all",
                                     path, name_of(unit), name_of(*before)));
    before = unit;
}

SkeletonFile load_skeleton(Run& run, const std::filesystem::path& path, const ReadSkeletonOptions& options) {
    const FileKind kind = kind_of_input(run, path, options.format);
    if (kind != FileKind::skeleton || is_sketch_name(path))
        throw UsageError(remedy_for(path, kind, "a skeleton"));
    SkeletonFile file = run.stage("read", [&](const Context& ctx) {
        if (const auto held = find_held<SkeletonFile>(run, path)) return held_skeleton(*held, options);
        return read_skeleton(path, options, ctx);
    });
    run.count_skeleton(file.skeleton);
    run.repairs() = compute_figures(file.report);
    return file;
}

PolygonMesh load_mesh(Run& run, const std::filesystem::path& path, FileUp up) {
    return load_mesh_file(run, path, {}, up).mesh;
}

MeshFile load_mesh_file(Run& run, const std::filesystem::path& path, std::span<const std::string> attributes,
                        FileUp up) {
    const auto held = find_held<HeldSurface>(run, path);
    MeshFile file = run.stage("read", [&](const Context& ctx) {
        return held ? to_mesh_file(*held, attributes) : read_mesh_file(path, attributes, ctx);
    });
    if (!held && mesh_format_of_name(path) != MeshFormat::glb) turn_from_file(file.mesh, up);
    run.counts().update({{"vertices", file.mesh.positions.size()}, {"faces", file.mesh.face_count()}});
    return file;
}

PointFile load_point_file(Run& run, const std::filesystem::path& path, const PointColumns& columns, FileUp up,
                          const std::optional<ReadPointsOptions>& options) {
    const auto held = find_held<PointFile>(run, path);
    PointFile file = run.stage("read", [&](const Context& ctx) {
        if (held) return *held;
        try {
            return read_point_file(path, columns, options.value_or(ReadPointsOptions{}), ctx);
        } catch (const TruncatedFile& error) {
            if (!options) throw;
            throw InvalidInput(
                fmt::format("{}; --allow-truncated reads the points that are there", error.what()));
        }
    });
    PointSet& points = file.point_cloud.points;
    if (!held) turn_from_file(points, up);
    run.counts()["points"] = points.size();
    if (file.without_return > 0) run.counts()["rays_without_return"] = file.without_return;
    if (file.missing > 0) {
        run.counts()["points_missing"] = file.missing;
        run.warn(
            fmt::format("{}: the file is cut off: its header names {} points more than the {} that are there",
                        path.string(), grouped(file.missing), grouped(points.size())));
    }
    if (const auto warning = warning_of_extent(points))
        run.warn(fmt::format("{}: {}", path.string(), *warning));
    return file;
}

PointSet load_points(Run& run, const std::filesystem::path& path, FileUp up,
                     const std::optional<ReadPointsOptions>& options) {
    return load_point_file(run, path, kNoColumns, up, options).point_cloud.points;
}

std::string text_of_rays_left_out(const PointFile& file) {
    if (file.without_return == 0) return {};
    return fmt::format(", {} rays without return left out", grouped(file.without_return));
}

}  // namespace coppice::cli
