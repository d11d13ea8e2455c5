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
#include "coppice/io_database/map_file.h"
#include "coppice/io_points/writer.h"
#include "coppice/render/colors.h"
#include "coppice/scene/extraction.h"
#include "csv_file.h"
#include "figures.h"
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

std::string name_of_tree(std::size_t tree, const std::string& extension) {
    return fmt::format("tree_{:03}{}", tree + 1, extension);
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
void write_surfaces(Run& run, std::vector<PlotTree>& trees, const ExtractOutputs& outputs,
                    const UnfinishedFolder& folder) {
    run.stage("mesh", [&](const Context& ctx) {
        for (std::size_t t = 0; t < trees.size(); ++t) {
            ctx.throw_if_cancelled();
            ctx.report(static_cast<float>(t) / static_cast<float>(trees.size()));
            if (!trees[t].result) continue;
            const Context part{.threads = ctx.threads, .stop = ctx.stop, .progress = {}};
            try {
                const MeshResult made = mesh_skeleton(trees[t].result->skeleton, outputs.surface, part);
                write_surface(folder / name_of_tree(t, outputs.mesh.string()), made, {}, part);
            } catch (const InvalidInput& error) {
                trees[t].warnings.push_back(fmt::format("no surface: {}", error.what()));
            } catch (const Unsupported& error) {
                trees[t].warnings.push_back(fmt::format("no surface: {}", error.what()));
            }
        }
    });
}

void write_leaves(const fs::path& path, const PlotExtraction& plot, const PointFile& scan,
                  const Context& ctx) {
    PointCloud leaves{{{}, scan.point_cloud.points.origin}, {}, {}};
    const std::vector<PlotTree>& trees = plot.trees;
    for (std::size_t t = 0; t < trees.size(); ++t) {
        if (!trees[t].result) continue;
        const auto& of = trees[t].result->leaves.positions;
        auto& all = leaves.points.positions;
        all.insert(all.end(), of.begin(), of.end());
        leaves.tree_ids.resize(all.size(), id_of_tree(plot.segments, t));
    }
    if (!leaves.points.empty()) write_point_cloud(path, leaves, {.system = scan.system}, ctx);
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

std::string format_summary(const std::vector<PlotTree>& trees, const fs::path& folder) {
    std::size_t failed = 0, warned = 0;
    for (const PlotTree& tree : trees) {
        failed += !tree.result;
        warned += !tree.warnings.empty();
    }
    std::string out = fmt::format("{}: {} trees", (folder / kTreeTable).string(), grouped(trees.size()));
    if (failed > 0) out += fmt::format(", {} without a skeleton", grouped(failed));
    if (warned > 0) out += fmt::format(", {} with warnings", grouped(warned));
    return out;
}

}  // namespace

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
                      .skeleton = tree.result ? (folder / name_of_tree(t, written.extension)).string() : "",
                      .foot = tree.form.foot,
                      .figures = tree.result ? &tree.figures : nullptr,
                      .of_plot = &tree,
                      .color = fmt::format("#{:02x}{:02x}{:02x}", color[0], color[1], color[2]),
                      .warnings = fmt::format("{}", fmt::join(tree.warnings, "; "))},
                     columns));
    }
    return rows;
}

WrittenPlot write_plot(Run& run, const PointFile& scan, PlotExtraction plot, const ExtractOutputs& outputs) {
    WrittenPlot out{std::move(plot), skeleton_extension(outputs.write), {}};
    std::vector<PlotTree>& trees = out.plot.trees;
    const PlotSegments& segments = out.plot.segments;
    const fs::path named = trimmed(outputs.skeleton);
    UnfinishedFolder folder(named);
    run.stage("write", [&](const Context& ctx) {
        for (std::size_t t = 0; t < trees.size(); ++t) {
            if (!trees[t].result) continue;
            try {
                const CloudExtraction& found = *trees[t].result;
                write_skeleton(folder / name_of_tree(t, out.extension), found.skeleton, outputs.write,
                               node_attributes(found.confidence, true), ctx);
            } catch (const Unsupported& error) {
                trees[t].warnings.emplace_back(error.what());
                trees[t].result.reset();
            }
        }
    });
    if (!outputs.mesh.empty()) write_surfaces(run, trees, outputs, folder);
    const std::vector<Json> rows = plot_rows(out);
    run.stage("write tables", [&](const Context& ctx) {
        write_rows(folder / kTreeTable, rows);
        write_taper(folder / kTaperTable, trees);
        if (!outputs.map.empty())
            write_map(outputs.map, make_layers(trees, rows), to_map_crs(outputs, scan.system), ctx);
    });
    if (!outputs.crowns.empty()) write_crowns(run, outputs.crowns, merge_crowns(trees));
    run.stage("write points", [&](const Context& ctx) {
        if (!outputs.tree_points.empty()) {
            write_point_cloud(outputs.tree_points, labelled(scan.point_cloud, segments, trees, ctx),
                              {.note = "each tree in its own colour, as in trees.csv", .system = scan.system},
                              ctx);
        }
        if (!outputs.leaf_points.empty()) write_leaves(outputs.leaf_points, out.plot, scan, ctx);
        folder.commit();
    });
    warn_of_leftovers(run, named, trees.size());
    count(run, scan.point_cloud.points, segments, rows);
    out.summary = format_summary(trees, named);
    return out;
}

}  // namespace coppice::cli
