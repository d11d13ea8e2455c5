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

/// Of a folder only meshes and points are used, for plots only points; files that are named are always used.
void add_files(Batch& batch, const std::vector<fs::path>& inputs) {
    const auto is_wanted = [&](const std::optional<FileKind>& kind) {
        return kind == FileKind::points || (kind == FileKind::mesh && !batch.columns.of_plots);
    };
    for (const fs::path& input : inputs) {
        std::error_code error;
        const bool within = fs::is_directory(input, error);
        for (const fs::path& path : files_within({input})) {
            const auto kind = find_kind(path);
            if (within && !is_wanted(kind)) {
                ++batch.passed_over;
                continue;
            }
            batch.files.push_back({.input = path, .kind = kind});
        }
    }
}

/// Throws UsageError if two files would write the same output, or an output would overwrite an input.
void check_names(const Batch& batch) {
    std::map<fs::path, fs::path> inputs, writers{{resolved_path(batch.folder / kTreeTable), kTreeTable}};
    for (const BatchFile& file : batch.files) inputs.emplace(resolved_path(file.input), file.input);
    for (const BatchFile& file : batch.files) {
        for (const fs::path& output : written_files(file.outputs, batch.columns.of_plots)) {
            const fs::path target = resolved_path(output);
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

}  // namespace

bool is_batch(std::span<const fs::path> inputs) {
    std::error_code error;
    return inputs.size() > 1 || (!inputs.empty() && fs::is_directory(inputs.front(), error));
}

Batch plan_batch(const std::vector<fs::path>& inputs, const ExtractOutputs& outputs,
                 const TreeColumns& columns) {
    check_batch_outputs(outputs);
    Batch batch{.folder = trimmed(outputs.skeleton), .columns = columns, .files = {}};
    add_files(batch, inputs);
    if (batch.files.empty())
        throw InvalidInput(
            fmt::format("'{}' contains {}", inputs.front().string(),
                        columns.of_plots ? "no clouds of points" : "neither meshes nor clouds of points"));
    for (BatchFile& file : batch.files)
        file.outputs = make_outputs(file.input, outputs, columns.of_plots, file.kind != FileKind::mesh);
    check_names(batch);
    return batch;
}

BatchTable::BatchTable(const Batch& batch)
    : columns_(batch.columns), table_([&] {
          create_folder(batch.folder);
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
                          .skeleton = file.outputs.skeleton.filename().string(),
                          .foot = foot,
                          .figures = &tree,
                          .of_points = of_points,
                          .warnings = of_points ? fmt::format("{}", fmt::join(tree.doubts, "; ")) : "",
                          .error = error},
                         columns_));
    }
}

void BatchTable::add(const BatchFile& file, const WrittenPlot& plot) {
    for (const Json& row : plot_rows(plot, file.input.string(), file.outputs.skeleton.filename()))
        add_row(row);
}

void BatchTable::add_failure(const BatchFile& file, std::string_view error) {
    add_row(tree_row({.input = file.input.string(), .error = std::string(error)}, columns_));
}

void BatchTable::add_row(const Json& row) {
    table_.add(row);
    rows_.push_back(row);
}

}  // namespace coppice::cli
