#include "plots.h"

#include <fmt/format.h>

#include <algorithm>
#include <charconv>
#include <cmath>
#include <string_view>
#include <system_error>
#include <utility>

#include "coppice/base/error.h"
#include "coppice/extract/tree/label_points.h"
#include "coppice/io_mesh/format.h"
#include "coppice/io_points/writer.h"
#include "coppice/io_skeleton/format.h"
#include "coppice/render/colors.h"
#include "coppice/scene/extraction.h"
#include "csv_file.h"
#include "figures.h"
#include "files.h"
#include "options.h"
#include "surfaces.h"
#include "tree_row.h"
#include "tree_tables.h"

namespace coppice::cli {
namespace {

namespace fs = std::filesystem;

constexpr const char* kTaperTable = "taper.csv";
constexpr Rgb kGroundColor{110, 95, 80};

/// A folder that is filled under a hidden name next to its final name; removed unless `commit` renames it.
class UnfinishedFolder {
  public:
    explicit UnfinishedFolder(fs::path target) : target_(std::move(target)) {
        hidden_ = target_.parent_path() / fmt::format(".{}.unfinished", target_.filename().string());
        std::error_code error;
        fs::remove_all(hidden_, error);
        fs::create_directory(hidden_, error);
        if (error)
            throw IoError(
                fmt::format("cannot create the folder '{}': {}", target_.string(), error.message()));
    }
    ~UnfinishedFolder() {
        std::error_code error;
        fs::remove_all(hidden_, error);
    }
    UnfinishedFolder(const UnfinishedFolder&) = delete;
    UnfinishedFolder& operator=(const UnfinishedFolder&) = delete;

    fs::path operator/(const std::string& name) const { return hidden_ / name; }

    /// Existing files stay, except those of the same names. The table is moved last.
    void commit() {
        std::error_code error;
        if (!fs::exists(target_)) {
            fs::rename(hidden_, target_, error);
        } else {
            for (const auto& file : fs::directory_iterator(hidden_)) {
                if (!error && file.path().filename() != kTreeTable)
                    fs::rename(file.path(), target_ / file.path().filename(), error);
            }
            if (!error) fs::rename(hidden_ / kTreeTable, target_ / kTreeTable, error);
        }
        if (error) throw IoError(fmt::format("cannot write to '{}': {}", target_.string(), error.message()));
    }

  private:
    fs::path target_, hidden_;
};

std::string name_of_tree(std::size_t tree, const std::string& ending) {
    return fmt::format("tree_{:03}{}", tree + 1, ending);
}

/// Returns the number of a tree in its point file, or else in the table.
std::uint32_t id_of_tree(const PlotSegments& segments, std::size_t tree) {
    return segments.ids.empty() ? static_cast<std::uint32_t>(tree + 1) : segments.ids[tree];
}

/// Writes colours, ids as in the table, LAS classes, the labels that the skeletons assign to points, and the
/// intensities and returns of the scan.
PointCloud labelled(const PointCloud& scan, const PlotSegments& segments, const std::vector<PlotTree>& trees,
                    const Context& ctx) {
    constexpr std::uint8_t kUnclassified = 1, kGround = 2, kHighVegetation = 5;
    PointCloud out{.points = scan.points,
                   .distances = {},
                   .colors = {},
                   .intensities = scan.intensities,
                   .return_numbers = scan.return_numbers,
                   .return_counts = scan.return_counts};
    std::vector<std::vector<std::uint32_t>> points_of(trees.size());
    for (std::uint32_t p = 0; p < segments.tree_of.size(); ++p) {
        const std::uint32_t tree = segments.tree_of[p];
        const bool none = tree == kPointOfGround || tree == kPointOfNoTree;
        if (!none) points_of[tree].push_back(p);
        out.tree_ids.push_back(none ? 0 : id_of_tree(segments, tree));
        out.classes.push_back(tree == kPointOfGround ? kGround : none ? kUnclassified : kHighVegetation);
        out.colors.push_back(tree == kPointOfGround ? kGroundColor
                             : none                 ? kNoTreeColor
                                                    : numbered_color(tree));
    }
    for (std::size_t t = 0; t < trees.size(); ++t)
        if (trees[t].result)
            label_points(out, points_of[t], *trees[t].result, trees[t].result->cleaning.spacing, ctx);
    return out;
}

void write_rows(const fs::path& path, const std::vector<Json>& rows) {
    CsvFile out(path);
    for (const Json& row : rows) out.add(row);
    out.commit();
}

/// Writes the sections of all stems from the circles fitted to the points.
void write_taper(const fs::path& path, const std::vector<PlotTree>& trees) {
    CsvFile out(path);
    for (std::size_t t = 0; t < trees.size(); ++t) add_taper(out, {{"tree", t + 1}}, trees[t].form);
    out.commit();
}

MapValue to_map_value(const Json& figure) {
    if (figure.is_number_float()) return figure.get<double>();
    if (figure.is_number_unsigned()) return figure.get<std::int64_t>();
    if (figure.is_string()) return figure.get<std::string>();
    return {};
}

/// Writes stems as points and crowns as polygons, both with the columns of the table.
std::vector<MapLayer> make_layers(const std::vector<PlotTree>& trees, const std::vector<Json>& rows) {
    MapLayer stems{"stems", MapGeometry::points, {}, {}}, crowns{"crowns", MapGeometry::polygons, {}, {}};
    for (const auto& [name, figure] : rows.front().items()) stems.columns.push_back(name);
    crowns.columns = stems.columns;
    for (std::size_t t = 0; t < trees.size(); ++t) {
        std::vector<MapValue> values;
        for (const auto& [name, figure] : rows[t].items()) values.push_back(to_map_value(figure));
        stems.features.push_back({{trees[t].form.foot}, values});
        if (!trees[t].crown.outline.empty()) crowns.features.push_back({trees[t].crown.outline, values});
    }
    return {std::move(stems), std::move(crowns)};
}

TriMesh merge_crowns(const std::vector<PlotTree>& trees) {
    TriMesh out;
    for (const PlotTree& tree : trees) add_hull(out, tree.crown.hull);
    return out;
}

/// Writes the surface of each tree; a failure is reported in the row of the tree.
void write_surfaces(Run& run, std::vector<PlotTree>& trees, const PlotFiles& files,
                    const UnfinishedFolder& folder) {
    run.stage("mesh", [&](const Context& ctx) {
        for (std::size_t t = 0; t < trees.size(); ++t) {
            ctx.throw_if_cancelled();
            ctx.report(static_cast<float>(t) / static_cast<float>(trees.size()));
            if (!trees[t].result) continue;
            const Context part{.threads = ctx.threads, .stop = ctx.stop, .progress = {}};
            try {
                const MeshResult made = mesh_skeleton(trees[t].result->skeleton, files.surface, part);
                write_surface(folder / name_of_tree(t, files.mesh.string()), made, {}, part);
            } catch (const InvalidInput& error) {
                trees[t].warnings.push_back(fmt::format("no surface: {}", error.what()));
            } catch (const Unsupported& error) {
                trees[t].warnings.push_back(fmt::format("no surface: {}", error.what()));
            }
        }
    });
}

void write_leaves(const PlotFiles& files, const std::vector<PlotTree>& trees, const PlotSegments& segments,
                  Vec3d origin, const Context& ctx) {
    PointCloud leaves{{{}, origin}, {}, {}};
    for (std::size_t t = 0; t < trees.size(); ++t) {
        if (!trees[t].result) continue;
        const auto& of = trees[t].result->leaves.positions;
        auto& all = leaves.points.positions;
        all.insert(all.end(), of.begin(), of.end());
        leaves.tree_ids.resize(all.size(), id_of_tree(segments, t));
    }
    if (!leaves.points.empty()) write_point_cloud(files.leaf_points, leaves, {.system = files.system}, ctx);
}

void count(Run& run, const PointSet& points, const PlotSegments& segments, const std::vector<Json>& rows) {
    const auto count_points = [&](std::uint32_t label) {
        return std::ranges::count(segments.tree_of, label);
    };
    run.counts().update({{"trees", rows.size()},
                         {"points", points.size()},
                         {"ground_points", count_points(kPointOfGround)},
                         {"points_of_no_tree", count_points(kPointOfNoTree)},
                         {"ground_found", segments.terrain.is_ground},
                         {"trees_found", rows}});
}

/// Finds files of trees beyond the last one that an earlier run left; they would seem to belong to this run.
void warn_of_leftovers(Run& run, const fs::path& folder, std::size_t trees) {
    std::error_code error;
    std::size_t left = 0;
    for (const auto& file : fs::directory_iterator(folder, error)) {
        const std::string name = file.path().filename().string();
        std::size_t number = 0;
        constexpr std::string_view kPrefix = "tree_";
        if (!name.starts_with(kPrefix)) continue;
        std::from_chars(name.data() + kPrefix.size(), name.data() + name.size(), number);
        left += number > trees;
    }
    if (left == 0) return;
    run.warn(fmt::format("'{}' contains {} file{} of trees beyond number {}, from an earlier run",
                         folder.string(), grouped(left), left == 1 ? "" : "s", grouped(trees)));
}

std::string format_summary(const std::vector<PlotTree>& trees, const PlotFiles& files) {
    std::size_t failed = 0, warned = 0;
    for (const PlotTree& tree : trees) {
        failed += !tree.result;
        warned += !tree.warnings.empty();
    }
    std::string out =
        fmt::format("{}: {} trees", (trimmed(files.folder) / kTreeTable).string(), grouped(trees.size()));
    if (failed > 0) out += fmt::format(", {} without a skeleton", grouped(failed));
    if (warned > 0) out += fmt::format(", {} with warnings", grouped(warned));
    return out;
}

}  // namespace

bool is_plot_folder(const fs::path& output, SkeletonFormat format) {
    std::error_code error;
    if (output.empty()) return false;
    if (!output.has_filename() || fs::is_directory(output, error)) return true;
    return format == SkeletonFormat::automatic && !output.has_extension() && !fs::exists(output, error);
}

fs::path trimmed(const fs::path& path) { return path.has_filename() ? path : path.parent_path(); }

std::string choose_ending(const WriteSkeletonOptions& write) {
    switch (write.format) {
        case SkeletonFormat::automatic:
            return "swc";
        case SkeletonFormat::cylinders:
            return "csv";
        default:
            return std::string(name_of(write.format));
    }
}

void check_tree_folder(const fs::path& named, const WriteSkeletonOptions& write, const fs::path& mesh) {
    const fs::path folder = trimmed(named);
    std::error_code error;
    if (folder.empty() || (fs::exists(folder, error) && !fs::is_directory(folder, error)))
        throw UsageError(fmt::format("'{}' is not a folder; name one for the trees", named.string()));
    check_output_folder(folder);
    using enum SkeletonFormat;
    if (write.format == mat || write.format == raycloud || write.format == gel)
        throw UsageError(fmt::format("--format {} can only be read; use swc, cylinders, ply, obj or json",
                                     name_of(write.format)));
    if (!mesh.empty()) {
        const std::string ending = mesh.string();
        const auto format = mesh_format_of_name(fmt::format("tree{}", ending));
        if (ending.front() != '.' || !format || *format == MeshFormat::off) {
            throw UsageError(
                fmt::format("each tree of a folder has its own surface: --then-mesh takes an extension, "
                            ".obj, .ply, .stl, .glb or .usda, not '{}'",
                            ending));
        }
        if (ending.substr(1) == choose_ending(write))
            throw UsageError(
                fmt::format("skeletons and surfaces would both be NAME{}; use another --format or "
                            "--then-mesh",
                            ending));
    }
}

void check_map_output(const fs::path& path) {
    if (!map_format_of_name(path))
        throw UsageError(
            fmt::format("'{}' is not the name of a map; use the extension .geojson or .gpkg", path.string()));
    check_output_folder(path);
}

void check_plot_files(const PlotFiles& files) {
    check_tree_folder(files.folder, files.write, files.mesh);
    if (!files.leaf_points.empty()) check_points_output(files.leaf_points);
    if (!files.crowns.empty()) check_mesh_output(files.crowns);
    if (!files.map.empty()) check_map_output(files.map);
    if (files.tree_points.empty()) return;
    check_cloud_output(files.tree_points);
}

std::vector<Json> plot_rows(const WrittenPlot& written, const std::string& input, const fs::path& folder) {
    const PlotSegments& segments = written.plot.segments;
    const TreeColumns columns{
        .of_files = !input.empty(), .of_plots = true, .with_ids = !segments.ids.empty()};
    std::vector<Json> rows;
    for (std::size_t t = 0; t < written.plot.trees.size(); ++t) {
        const PlotTree& tree = written.plot.trees[t];
        const Rgb color = numbered_color(t);
        rows.push_back(
            tree_row({.input = input,
                      .tree = t + 1,
                      .id = id_of_tree(segments, t),
                      .skeleton = tree.result ? (folder / name_of_tree(t, written.ending)).string() : "",
                      .foot = tree.form.foot,
                      .figures = tree.result ? &tree.figures : nullptr,
                      .of_plot = &tree,
                      .color = fmt::format("#{:02x}{:02x}{:02x}", color[0], color[1], color[2]),
                      .warnings = fmt::format("{}", fmt::join(tree.warnings, "; "))},
                     columns));
    }
    return rows;
}

WrittenPlot write_plot(Run& run, const PointCloud& scan, PlotExtraction plot, const PlotFiles& files) {
    WrittenPlot out{std::move(plot), fmt::format(".{}", choose_ending(files.write)), {}};
    std::vector<PlotTree>& trees = out.plot.trees;
    const PlotSegments& segments = out.plot.segments;
    UnfinishedFolder folder(trimmed(files.folder));
    run.stage("write", [&](const Context& ctx) {
        for (std::size_t t = 0; t < trees.size(); ++t) {
            if (!trees[t].result) continue;
            try {
                const CloudExtraction& found = *trees[t].result;
                write_skeleton(folder / name_of_tree(t, out.ending), found.skeleton, files.write,
                               node_attributes(found.confidence, true), ctx);
            } catch (const Unsupported& error) {
                trees[t].warnings.emplace_back(error.what());
                trees[t].result.reset();
            }
        }
    });
    if (!files.mesh.empty()) write_surfaces(run, trees, files, folder);
    const std::vector<Json> rows = plot_rows(out);
    run.stage("write tables", [&](const Context& ctx) {
        write_rows(folder / kTreeTable, rows);
        write_taper(folder / kTaperTable, trees);
        if (!files.map.empty()) write_map(files.map, make_layers(trees, rows), files.crs, ctx);
    });
    if (!files.crowns.empty()) write_crowns(run, files.crowns, merge_crowns(trees));
    run.stage("write points", [&](const Context& ctx) {
        if (!files.tree_points.empty()) {
            write_point_cloud(
                files.tree_points, labelled(scan, segments, trees, ctx),
                {.note = "each tree in its own colour, as in trees.csv", .system = files.system}, ctx);
        }
        if (!files.leaf_points.empty()) write_leaves(files, trees, segments, scan.points.origin, ctx);
        folder.commit();
    });
    warn_of_leftovers(run, trimmed(files.folder), trees.size());
    count(run, scan.points, segments, rows);
    out.summary = format_summary(trees, files);
    return out;
}

}  // namespace coppice::cli
