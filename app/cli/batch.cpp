#include "batch.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <map>
#include <system_error>

#include "coppice/base/error.h"
#include "files.h"
#include "options.h"
#include "plots.h"

namespace coppice::cli {
namespace {

namespace fs = std::filesystem;

/// What a file holds, as far as that can be told before it is worked on.
std::optional<FileKind> kind_before(const fs::path& path) {
    try {
        return kind_of_file(path);
    } catch (const Error&) {
        return std::nullopt;
    }
}

/// What is found in a folder is taken where it is a mesh or points; what is named is, whatever it is.
Batch files_of(const std::vector<fs::path>& inputs) {
    Batch batch;
    for (const fs::path& input : inputs) {
        std::error_code error;
        const bool within = fs::is_directory(input, error);
        for (const fs::path& path : files_within({input})) {
            const auto kind = kind_before(path);
            if (within && (!kind || kind == FileKind::skeleton)) {
                ++batch.passed_over;
                continue;
            }
            batch.files.push_back({.input = path, .skeleton = {}, .mesh = {}, .points = {}, .kind = kind});
        }
    }
    return batch;
}

/// Throws UsageError where an output is that of another file, or an input.
void check_names(const Batch& batch) {
    std::map<fs::path, fs::path> inputs, writers{{resolved_path(batch.folder / kTreeTable), kTreeTable}};
    for (const BatchFile& file : batch.files) inputs.emplace(resolved_path(file.input), file.input);
    for (const BatchFile& file : batch.files) {
        for (const fs::path& output : {file.skeleton, file.mesh, file.points}) {
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

/// A figure, or an empty cell.
Figure cell_if(bool is_known, const Figure& figure) { return is_known ? figure : Figure(NotChecked{}); }

/// The row of a file without a tree, with all columns.
Figures empty_row(const BatchFile& file) {
    Figures row;
    row["input"] = file.input.string();
    for (const char* name : {"file", "tree", "x", "y", "z", "height_m", "dbh_m", "dbh_low_m", "dbh_high_m",
                             "dbh_of_skeleton_m", "length_m", "volume_m3", "volume_low_m3", "volume_high_m3",
                             "inferred", "form", "warnings", "error"})
        row[name] = NotChecked{};
    return row;
}

}  // namespace

bool is_batch(std::span<const fs::path> inputs) {
    std::error_code error;
    return inputs.size() > 1 || (!inputs.empty() && fs::is_directory(inputs.front(), error));
}

Batch plan_batch(const std::vector<fs::path>& inputs, const fs::path& folder,
                 const WriteSkeletonOptions& write, const fs::path& mesh, const fs::path& points) {
    check_tree_folder(folder, write, mesh);
    if (!points.empty()) {
        if (!points.string().starts_with('.'))
            throw UsageError(
                fmt::format("each of many files has points of its own: --tree-points takes an "
                            "ending, .las, .ply, .txt or .csv, not '{}'",
                            points.string()));
        check_painted_output(fmt::format("points{}", points.string()));
    }
    Batch batch = files_of(inputs);
    batch.folder = folder;
    if (batch.files.empty())
        throw InvalidInput(
            fmt::format("'{}' holds neither meshes nor clouds of points", inputs.front().string()));
    for (BatchFile& file : batch.files) {
        const std::string stem = file.input.stem().string();
        file.skeleton = folder / fmt::format("{}.{}", stem, ending_of(write));
        if (!mesh.empty()) file.mesh = folder / fmt::format("{}{}", stem, mesh.string());
        if (!points.empty() && file.kind != FileKind::mesh)
            file.points = folder / fmt::format("{}_points{}", stem, points.string());
    }
    check_names(batch);
    return batch;
}

BatchTable::BatchTable(const Batch& batch)
    : table_([&] {
          std::error_code error;
          fs::create_directory(batch.folder, error);
          if (error)
              throw IoError(
                  fmt::format("cannot make the folder '{}': {}", batch.folder.string(), error.message()));
          return batch.folder / kTreeTable;
      }()) {}

void BatchTable::add(const BatchFile& file, const ExtractResult& result, std::span<const TreeFigures> trees,
                     bool of_points) {
    const Skeleton& s = result.skeleton;
    std::size_t t = 0;
    for (const NodeId n : nodes(s)) {
        if (!s.is_root(n)) continue;
        const TreeFigures& tree = trees[t++];
        const Vec3d foot = s.origin() + Vec3d(s.position(n));
        Figures row = empty_row(file);
        row["file"] = file.skeleton.filename().string();
        row["tree"] = t;
        row["x"] = foot.x;
        row["y"] = foot.y;
        row["z"] = foot.z;
        row["height_m"] = tree.height;
        row["dbh_m"] = cell_if(tree.dbh_of_points > 0, tree.dbh_of_points);
        row["dbh_low_m"] = cell_if(tree.dbh_of_points > 0, tree.dbh_low);
        row["dbh_high_m"] = cell_if(tree.dbh_of_points > 0, tree.dbh_high);
        row["dbh_of_skeleton_m"] = cell_if(tree.dbh > 0, tree.dbh);
        row["length_m"] = tree.length;
        row["volume_m3"] = tree.volume;
        row["volume_low_m3"] = cell_if(of_points, tree.volume_low);
        row["volume_high_m3"] = cell_if(of_points, tree.volume_high);
        row["inferred"] = cell_if(of_points, tree.inferred);
        row["form"] = cell_if(tree.form > 0, tree.form);
        if (of_points) row["warnings"] = fmt::format("{}", fmt::join(tree.doubts, "; "));
        add_row(row);
    }
}

void BatchTable::add_failure(const BatchFile& file, std::string_view error) {
    Figures row = empty_row(file);
    row["error"] = std::string(error);
    add_row(row);
}

void BatchTable::add_row(const Figures& row) {
    table_.add(row);
    rows_.emplace_back(row);
}

}  // namespace coppice::cli
