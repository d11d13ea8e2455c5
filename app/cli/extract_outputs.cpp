#include "extract_outputs.h"

#include <fmt/format.h>

#include <array>
#include <system_error>

#include "command.h"
#include "coppice/base/error.h"
#include "coppice/io_mesh/format.h"
#include "coppice/io_skeleton/format.h"
#include "files.h"

namespace coppice::cli {
namespace {

namespace fs = std::filesystem;

void check_map_output(const fs::path& path) {
    if (!map_format_of_name(path))
        throw UsageError(
            fmt::format("'{}' is not the name of a map; use the extension .geojson or .gpkg", path.string()));
    check_output_folder(path);
}

/// An output besides skeletons and their surfaces.
struct OtherOutput {
    fs::path ExtractOutputs::*path;
    const char *group, *flag, *type, *help;
    void (*check)(const fs::path&);
    const char* subject;     ///< of many files: NAME_subject.ply; null: only for one file
    const char* extensions;  ///< for many files, in messages
};

constexpr std::array kOtherOutputs{
    OtherOutput{&ExtractOutputs::mapping, kMeshGroup, "--mapping", "PLY",
                "Also write the vertices, coloured by the nodes of the skeleton.", check_cloud_output,
                nullptr, nullptr},
    OtherOutput{
        &ExtractOutputs::leaf_points, kCloudGroup, "--leaf-points", "POINTS",
        "Also write the points that are removed as leaves, if any; for many files with this extension.",
        check_points_output, "leaves", ".las, .ply, .txt or .csv"},
    OtherOutput{
        &ExtractOutputs::tree_points, kCloudGroup, "--tree-points", "POINTS",
        "Also write all points with their labels: wood or not, order and evidence of their branch, in a plot "
        "id and colour of their tree; for many files with this extension (.las).",
        check_cloud_output, "points", ".las, .ply, .txt or .csv"},
    OtherOutput{&ExtractOutputs::map, kPlotGroup, "--map", "MAP",
                "Also write a map of stems and crowns with the columns of the table (.gpkg, .geojson); "
                "for many plots with this extension.",
                check_map_output, "map", ".gpkg or .geojson"},
    OtherOutput{&ExtractOutputs::crowns, kPlotGroup, "--crowns", "MESH",
                "Also write the convex hulls of all crowns (.ply, .obj); for many plots with this extension.",
                check_mesh_output, "crowns", ".ply or .obj"}};

/// Checks the outputs besides skeletons and surfaces.
void check_other_outputs(const ExtractOutputs& outputs) {
    for (const OtherOutput& other : kOtherOutputs)
        if (const fs::path& path = outputs.*other.path; !path.empty()) other.check(path);
}

/// Throws UsageError if the folder is not a folder, skeletons cannot be written in the format, or the mesh is
/// not an extension of surfaces or equals that of the skeletons; IoError if the parent folder does not exist.
void check_tree_folder(const ExtractOutputs& outputs) {
    const fs::path folder = trimmed(outputs.skeleton);
    std::error_code error;
    if (folder.empty() || (fs::exists(folder, error) && !fs::is_directory(folder, error)))
        throw UsageError(
            fmt::format("'{}' is not a folder; name one for the trees", outputs.skeleton.string()));
    check_output_folder(folder);
    using enum SkeletonFormat;
    const SkeletonFormat written = outputs.write.format;
    if (written == mat || written == raycloud || written == gel)
        throw UsageError(fmt::format("--format {} can only be read; use swc, cylinders, ply, obj or json",
                                     name_of(written)));
    if (outputs.mesh.empty()) return;
    const std::string extension = outputs.mesh.string();
    const auto format = mesh_format_of_name(fmt::format("tree{}", extension));
    if (extension.front() != '.' || !format || *format == MeshFormat::off)
        throw UsageError(
            fmt::format("each tree of a folder has its own surface: --then-mesh takes an extension, .obj, "
                        ".ply, .stl, .glb or .usda, not '{}'",
                        extension));
    if (extension == skeleton_extension(outputs.write))
        throw UsageError(fmt::format(
            "skeletons and surfaces would both be NAME{}; use another --format or --then-mesh", extension));
}

}  // namespace

void add_output_options(OptionList& options, ExtractOutputs& outputs, std::string_view group) {
    if (group.empty()) {
        options.output(
            "-o,--output", "SKELETON", outputs.skeleton,
            "Skeleton to write, with an extension that selects the format; or a folder for the trees "
            "of a plot or of many files, which are all plots if an option for plots is given.");
        options.output("--then-mesh", "MESH", outputs.mesh,
                       "Also write the surface of the skeleton; for a folder, of every tree with this "
                       "extension (.ply).");
    }
    for (const OtherOutput& other : kOtherOutputs) {
        if (other.group != group) continue;
        options.output(other.flag, other.type, outputs.*other.path, other.help,
                       {.group = other.group, .common = false});
        if (other.path != &ExtractOutputs::map) continue;
        options.file("--crs", "EPSG:NUMBER", outputs.crs,
                     "Coordinate reference system of the cloud, which is stored in the map, as EPSG:32632.",
                     {.group = other.group, .common = false});
    }
}

void check_tree_outputs(const ExtractOutputs& outputs) {
    if (outputs.write.format == SkeletonFormat::automatic &&
        kind_to_write(outputs.skeleton, FileKind::skeleton) != FileKind::skeleton) {
        throw UsageError(
            fmt::format("'{}' is the name of a mesh; name the skeleton, and the mesh with --then-mesh",
                        outputs.skeleton.string()));
    }
    check_output_folder(outputs.skeleton);
    if (!outputs.mesh.empty()) check_mesh_output(outputs.mesh);
    check_other_outputs(outputs);
}

void check_plot_outputs(const ExtractOutputs& outputs) {
    (void)to_map_crs(outputs);
    check_tree_folder(outputs);
    check_other_outputs(outputs);
}

void check_batch_outputs(const ExtractOutputs& outputs) {
    (void)to_map_crs(outputs);
    check_tree_folder(outputs);
    for (const OtherOutput& other : kOtherOutputs) {
        const std::string extension = (outputs.*other.path).string();
        if (extension.empty()) continue;
        if (other.subject == nullptr)
            throw UsageError(fmt::format("{} is for one file; name only one, and its skeleton", other.flag));
        if (!extension.starts_with('.'))
            throw UsageError(
                fmt::format("each of many files has its own output: {} takes an extension, {}, not '{}'",
                            other.flag, other.extensions, extension));
        other.check(fmt::format("name{}", extension));
    }
}

ExtractOutputs make_outputs(const fs::path& input, const ExtractOutputs& batch, bool of_plots,
                            bool may_be_points) {
    const fs::path folder = trimmed(batch.skeleton);
    const std::string name = input.stem().string();
    ExtractOutputs out = batch;
    for (const OtherOutput& other : kOtherOutputs) {
        const fs::path& extension = batch.*other.path;
        if (extension.empty()) continue;
        out.*other.path = may_be_points
                              ? folder / fmt::format("{}_{}{}", name, other.subject, extension.string())
                              : fs::path();
    }
    out.skeleton = folder / (of_plots ? name : name + skeleton_extension(batch.write));
    if (!of_plots && !batch.mesh.empty()) out.mesh = folder / (name + batch.mesh.string());
    return out;
}

std::vector<fs::path> written_files(const ExtractOutputs& outputs, bool of_plot) {
    std::vector<fs::path> out{outputs.skeleton};
    if (!of_plot) out.push_back(outputs.mesh);
    for (const OtherOutput& other : kOtherOutputs) out.push_back(outputs.*other.path);
    std::erase(out, fs::path());
    return out;
}

MapCrs to_map_crs(const ExtractOutputs& outputs, const CoordinateSystem& points) {
    MapCrs out;
    if (!outputs.crs.empty()) {
        if (outputs.map.empty()) throw UsageError("--crs is the reference system of a map; add --map FILE");
        out = as_usage("--crs: ", [&] { return parse_crs(outputs.crs.string()); });
    }
    if (!out.undefined()) return out;
    if (const std::string name = points.name(); name.starts_with("EPSG:")) out = parse_crs(name);
    for (const CoordinateSystem::Record& record : points.records)
        if (record.id == CoordinateSystem::kWkt) out.wkt = record.data.c_str();
    return out;
}

bool is_plot_folder(const ExtractOutputs& outputs) {
    const fs::path& path = outputs.skeleton;
    std::error_code error;
    if (path.empty()) return false;
    if (!path.has_filename() || fs::is_directory(path, error)) return true;
    return outputs.write.format == SkeletonFormat::automatic && !path.has_extension() &&
           !fs::exists(path, error);
}

fs::path trimmed(const fs::path& path) { return path.has_filename() ? path : path.parent_path(); }

std::string skeleton_extension(const WriteSkeletonOptions& write) {
    switch (write.format) {
        case SkeletonFormat::automatic:
            return ".swc";
        case SkeletonFormat::cylinders:
            return ".csv";
        default:
            return fmt::format(".{}", name_of(write.format));
    }
}

}  // namespace coppice::cli
