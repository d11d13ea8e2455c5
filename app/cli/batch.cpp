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
#include "tree_row.h"

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

constexpr TreeColumns kColumns{.of_files = true};

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
        add_row(tree_row({.input = file.input.string(),
                          .tree = t,
                          .skeleton = file.skeleton.filename().string(),
                          .foot = foot,
                          .figures = &tree,
                          .of_points = of_points,
                          .warnings = of_points ? fmt::format("{}", fmt::join(tree.doubts, "; ")) : ""},
                         kColumns));
    }
}

void BatchTable::add_failure(const BatchFile& file, std::string_view error) {
    add_row(tree_row({.input = file.input.string(), .error = std::string(error)}, kColumns));
}

void BatchTable::add_row(const Figures& row) {
    table_.add(row);
    rows_.emplace_back(row);
}

}  // namespace coppice::cli
