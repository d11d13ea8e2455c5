#include "batch.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <map>
#include <system_error>

#include "coppice/base/error.h"
#include "files.h"
#include "options.h"

namespace coppice::cli {
namespace {

namespace fs = std::filesystem;

/// Returns the kind of a file, or nullopt where it cannot be determined before the file is read.
std::optional<FileKind> kind_before(const fs::path& path) {
    try {
        return kind_of_file(path);
    } catch (const Error&) {
        return std::nullopt;
    }
}

/// Of a folder only meshes and points are used, for plots only points; files that are named are always used.
Batch make_batch(const std::vector<fs::path>& inputs, const BatchOutputs& outputs) {
    Batch batch{.folder = outputs.folder, .columns = outputs.columns, .files = {}};
    const auto is_wanted = [&](const std::optional<FileKind>& kind) {
        return kind == FileKind::points || (kind == FileKind::mesh && !outputs.columns.of_plots);
    };
    for (const fs::path& input : inputs) {
        std::error_code error;
        const bool within = fs::is_directory(input, error);
        for (const fs::path& path : files_within({input})) {
            const auto kind = kind_before(path);
            if (within && !is_wanted(kind)) {
                ++batch.passed_over;
                continue;
            }
            batch.files.push_back({.input = path, .kind = kind});
        }
    }
    return batch;
}

/// Throws UsageError if two files would write the same output, or an output would overwrite an input.
void check_names(const Batch& batch) {
    std::map<fs::path, fs::path> inputs, writers{{resolved_path(batch.folder / kTreeTable), kTreeTable}};
    for (const BatchFile& file : batch.files) inputs.emplace(resolved_path(file.input), file.input);
    for (const BatchFile& file : batch.files) {
        for (const fs::path& output : {file.skeleton, batch.columns.of_plots ? fs::path() : file.mesh,
                                       file.points, file.leaves, file.map, file.crowns}) {
            const fs::path target = output.empty() ? output : resolved_path(output);
            if (target.empty()) continue;
            if (const auto input = inputs.find(target); input != inputs.end())
                throw UsageError(fmt::format("'{}' would overwrite an input; name another folder or --format",
                                             output.string()));
            const auto [other, is_new] = writers.emplace(target, file.input);
            if (!is_new)
                throw UsageError(fmt::format("'{}' and '{}' would both write '{}'; rename one of them",
                                             other->second.string(), file.input.string(), output.string()));
        }
    }
}

/// Throws UsageError for an extension that is not that of a supported format.
void check_outputs(const BatchOutputs& outputs) {
    check_tree_folder(outputs.folder, outputs.write, outputs.mesh);
    const auto check = [](const char* option, const char* endings, const fs::path& ending) {
        if (ending.string().starts_with('.')) return fs::path(fmt::format("name{}", ending.string()));
        throw UsageError(
            fmt::format("each of many files has its own output: {} takes an extension, {}, not '{}'", option,
                        endings, ending.string()));
    };
    constexpr const char* kPoints = ".las, .ply, .txt or .csv";
    if (!outputs.points.empty()) check_cloud_output(check("--tree-points", kPoints, outputs.points));
    if (!outputs.leaves.empty()) check_points_output(check("--leaf-points", kPoints, outputs.leaves));
    if (!outputs.crowns.empty()) check_mesh_output(check("--crowns", ".ply or .obj", outputs.crowns));
    if (!outputs.map.empty()) check_map_output(check("--map", ".gpkg or .geojson", outputs.map));
}

}  // namespace

bool is_batch(std::span<const fs::path> inputs) {
    std::error_code error;
    return inputs.size() > 1 || (!inputs.empty() && fs::is_directory(inputs.front(), error));
}

Batch plan_batch(const std::vector<fs::path>& inputs, const BatchOutputs& outputs) {
    check_outputs(outputs);
    Batch batch = make_batch(inputs, outputs);
    if (batch.files.empty())
        throw InvalidInput(fmt::format(
            "'{}' contains {}", inputs.front().string(),
            batch.columns.of_plots ? "no clouds of points" : "neither meshes nor clouds of points"));
    for (BatchFile& file : batch.files) {
        const std::string stem = file.input.stem().string();
        const auto named = [&](const char* subject, const fs::path& ending) {
            return ending.empty() || file.kind == FileKind::mesh
                       ? fs::path()
                       : batch.folder / fmt::format("{}_{}{}", stem, subject, ending.string());
        };
        file.points = named("points", outputs.points);
        file.leaves = named("leaves", outputs.leaves);
        file.map = named("map", outputs.map);
        file.crowns = named("crowns", outputs.crowns);
        if (batch.columns.of_plots) {
            file.skeleton = batch.folder / stem;
            file.mesh = outputs.mesh;
            continue;
        }
        file.skeleton = batch.folder / fmt::format("{}.{}", stem, choose_ending(outputs.write));
        if (!outputs.mesh.empty())
            file.mesh = batch.folder / fmt::format("{}{}", stem, outputs.mesh.string());
    }
    check_names(batch);
    return batch;
}

BatchTable::BatchTable(const Batch& batch)
    : columns_(batch.columns), table_([&] {
          std::error_code error;
          fs::create_directory(batch.folder, error);
          if (error)
              throw IoError(
                  fmt::format("cannot create the folder '{}': {}", batch.folder.string(), error.message()));
          return batch.folder / kTreeTable;
      }()) {}

void BatchTable::add(const BatchFile& file, const ExtractResult& result, std::span<const TreeFigures> trees,
                     bool of_points, const std::string& error) {
    const Skeleton& s = result.skeleton;
    std::size_t t = 0;
    for (const NodeId n : nodes(s)) {
        if (!s.is_root(n)) continue;
        const TreeFigures& tree = trees[t++];
        const Vec3d foot = s.origin() + Vec3d(s.position(n));
        add_row(tree_row({.input = file.input.string(),
                          .tree = t,
                          .skeleton = file.skeleton.filename().string(),
                          .foot = foot,
                          .figures = &tree,
                          .of_points = of_points,
                          .warnings = of_points ? fmt::format("{}", fmt::join(tree.doubts, "; ")) : "",
                          .error = error},
                         columns_));
    }
}

void BatchTable::add(const BatchFile& file, const WrittenPlot& plot) {
    for (const Json& row : plot_rows(plot, file.input.string(), file.skeleton.filename())) add_row(row);
}

void BatchTable::add_failure(const BatchFile& file, std::string_view error) {
    add_row(tree_row({.input = file.input.string(), .error = std::string(error)}, columns_));
}

void BatchTable::add_row(const Json& row) {
    table_.add(row);
    rows_.push_back(row);
}

}  // namespace coppice::cli
