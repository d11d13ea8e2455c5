#include "outputs.h"

#include <fmt/format.h>

#include <algorithm>
#include <filesystem>
#include <vector>

#include "files.h"

namespace coppice::cli {
namespace {

namespace fs = std::filesystem;

struct NamedFile {
    const Option* option;
    fs::path name;    ///< as given
    fs::path target;  ///< see resolved_path()
};

/// Returns whether writing a file of this name replaces an existing file; false for devices, pipes and
/// folders.
bool is_replaced(const fs::path& path) {
    std::error_code error;
    const fs::file_status status = fs::status(path, error);
    return !fs::exists(status) || fs::is_regular_file(status);
}

/// Returns whether the path is an extension such as ".ply", which names the outputs of many files.
bool is_ending(const fs::path& path) {
    std::error_code error;
    return path == path.filename() && path.string().starts_with('.') && !path.has_extension() &&
           !fs::exists(path, error);
}

std::vector<fs::path> list_names(const OptionTarget& target) {
    if (const auto* one = std::get_if<fs::path*>(&target)) return {**one};
    if (const auto* many = std::get_if<std::vector<fs::path>*>(&target)) return **many;
    return {};
}

std::vector<NamedFile> list_files(const GivenOptions& given, bool outputs) {
    std::vector<NamedFile> files;
    for (const Option* option : given) {
        if (option->is_output != outputs) continue;
        for (const fs::path& name : list_names(option->target)) {
            if (outputs && is_ending(name)) continue;
            const fs::path target = resolved_path(name);
            if (!target.empty() && is_replaced(target)) files.push_back({option, name, target});
        }
    }
    return files;
}

}  // namespace

void check_outputs(const GivenOptions& given) {
    const std::vector<NamedFile> inputs = list_files(given, false), outputs = list_files(given, true);
    for (std::size_t i = 0; i < outputs.size(); ++i) {
        const NamedFile& output = outputs[i];
        for (std::size_t k = 0; k < i; ++k) {
            if (outputs[k].target == output.target)
                throw UsageError(fmt::format("{} and {} both write '{}'; name two different files",
                                             outputs[k].option->name, output.option->name,
                                             output.name.string()));
        }
        for (const NamedFile& input : inputs) {
            const bool is_allowed = std::ranges::find(output.option->replaces, input.option->name) !=
                                    output.option->replaces.end();
            if (input.target == output.target && !is_allowed)
                throw UsageError(fmt::format("{} would overwrite '{}', which is an input; name another file",
                                             output.option->name, output.name.string()));
        }
    }
}

}  // namespace coppice::cli
