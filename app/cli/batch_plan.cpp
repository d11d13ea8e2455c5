#include "batch_plan.h"

#include <fmt/format.h>

#include <algorithm>
#include <map>
#include <string>
#include <string_view>
#include <system_error>

#include "coppice/base/error.h"
#include "coppice/base/quote.h"
#include "coppice/system/file.h"
#include "files.h"
#include "tree_row.h"

namespace coppice::cli {
namespace {

namespace fs = std::filesystem;

bool is_folder(const fs::path& path) {
    std::error_code error;
    return fs::is_directory(path, error) || (!path.empty() && path.filename().empty());
}

bool is_list(const fs::path& path) { return path == "-" || path.string().starts_with('@'); }

std::vector<fs::path> paths_of(const Option& option) {
    if (const auto* many = std::get_if<std::vector<fs::path>*>(&option.target)) return **many;
    const fs::path& one = *std::get<fs::path*>(option.target);
    return one.empty() ? std::vector<fs::path>{} : std::vector{one};
}

bool takes_one(const Option& option) { return std::holds_alternative<fs::path*>(option.target); }

/// Returns the lines of a list without empty ones.
std::vector<fs::path> read_list(const fs::path& list) {
    const std::string name = list == "-" || list == "@-" ? "/dev/stdin" : list.string().substr(1);
    const std::string text = read_file(name);
    std::vector<fs::path> out;
    for (std::size_t begin = 0; begin < text.size();) {
        const std::size_t end = std::min(text.find('\n', begin), text.size());
        std::string line = text.substr(begin, end - begin);
        if (line.ends_with('\r')) line.pop_back();
        if (!line.empty()) out.emplace_back(std::move(line));
        begin = end + 1;
    }
    return out;
}

bool is_read_by(const ManyFiles& many, const fs::path& path) {
    if (path.filename() == kTreeTable || path.filename() == kBatchJournal) return false;
    const auto kind = find_kind(path);
    return kind && std::ranges::find(many.kinds, *kind) != many.kinds.end();
}

void add_inputs(FileBatch& batch, const ManyFiles& many, const fs::path& named) {
    if (!is_folder(named)) return batch.items.push_back({named, {}});
    for (const fs::path& path : files_within({named})) {
        if (is_read_by(many, path))
            batch.items.push_back({path, {}});
        else
            ++batch.passed_over;
    }
}

/// Returns the name of an output: the template with the parts of the input in place of {stem} and so on.
std::string expand(std::string_view pattern, const fs::path& input, std::size_t number) {
    const std::map<std::string_view, std::string> parts{
        {"{stem}", input.stem().string()},
        {"{file}", input.filename().string()},
        {"{folder}", resolved_path(input).parent_path().filename().string()},
        {"{number}", std::to_string(number)}};
    std::string out;
    while (!pattern.empty()) {
        const std::size_t open = std::min(pattern.find('{'), pattern.size());
        out += pattern.substr(0, open);
        pattern.remove_prefix(open);
        if (pattern.empty()) break;
        const std::string_view place = pattern.substr(0, std::min(pattern.find('}'), pattern.size() - 1) + 1);
        const auto part = parts.find(place);
        if (part == parts.end())
            throw UsageError(fmt::format("--name knows {{stem}}, {{file}}, {{folder}} and {{number}}, not {}",
                                         quote(place)));
        out += part->second;
        pattern.remove_prefix(place.size());
    }
    return out;
}

std::string pattern_of(const Run& run, const Command& command, const fs::path& folder) {
    const std::string given = run.flags().batch.name.string();
    if (given.empty() && command.many->extension.empty()) {
        throw UsageError(fmt::format(
            "'{}' is a folder; name the outputs in it, as --name '{{stem}}.obj', because coppice {} "
            "needs their extension",
            folder.string(), command.name));
    }
    if (given.find('/') != std::string::npos)
        throw UsageError(
            fmt::format("--name is the name of a file in the output folder, not of a path; {} "
                        "contains a slash",
                        quote(given)));
    return given.empty() ? "{stem}" + std::string(command.many->extension) : given;
}

void name_outputs(FileBatch& batch, const std::string& pattern) {
    std::map<fs::path, fs::path> inputs,
        writers{{kTreeTable, "the table of all files"}, {kBatchJournal, "the journal"}};
    for (const BatchItem& item : batch.items) inputs.emplace(resolved_path(item.input), item.input);
    std::size_t number = 0;
    for (BatchItem& item : batch.items) {
        const std::string name = expand(pattern, item.input, ++number);
        item.output = batch.folder / name;
        const auto [other, is_new] = writers.emplace(name, item.input);
        if (!is_new)
            throw UsageError(
                fmt::format("'{}' and '{}' would both write '{}'; distinguish them, as by "
                            "--name '{{folder}}_{{stem}}{}'",
                            other->second.string(), item.input.string(), item.output.string(),
                            item.output.extension().string()));
        if (inputs.contains(resolved_path(item.output)))
            throw UsageError(fmt::format("'{}' would overwrite an input; name another folder or --name",
                                         item.output.string()));
    }
}

/// Returns the output folder. Throws UsageError for other outputs, which every file would overwrite.
fs::path output_folder(const Parser::Request& request, const fs::path& input) {
    const Option& output = find_option(*request.command, "--output");
    const std::vector<fs::path> outputs = paths_of(output);
    if (outputs.size() != 1)
        throw UsageError(fmt::format(
            "'{}' is one of many files; name one folder for their results: coppice {} FILES... -o "
            "FOLDER",
            input.string(), request.command->name));
    std::error_code error;
    const fs::path& folder = outputs.front();
    if (!is_folder(folder) && (folder.has_extension() || fs::exists(folder, error)))
        throw UsageError(fmt::format(
            "'{}' is the name of a file; name a folder for the results of many files", folder.string()));
    for (const Option* option : request.given)
        if (option->is_output && option != &output && option->name != "--report")
            throw UsageError(
                fmt::format("{} names one file, which all inputs would write; process them "
                            "one by one",
                            option->name));
    return folder;
}

bool is_file_batch(const std::vector<fs::path>& inputs, const Parser::Request& request) {
    const bool takes_many = !takes_one(find_option(*request.command, request.command->many->input));
    return (inputs.size() > 1 && !takes_many) || std::ranges::any_of(inputs, is_folder) ||
           std::ranges::any_of(inputs, is_list) ||
           (!inputs.empty() &&
            std::ranges::any_of(paths_of(find_option(*request.command, "--output")), is_folder));
}

}  // namespace

const Option& find_option(const Command& command, std::string_view name) {
    return *std::ranges::find(command.options.all(), name, &Option::name);
}

std::optional<FileBatch> plan_file_batch(const Run& run, const Parser::Request& request) {
    const Command& command = *request.command;
    if (!command.many) return std::nullopt;
    std::vector<fs::path> inputs = paths_of(find_option(command, command.many->input));
    inputs.insert(inputs.end(), request.further.begin(), request.further.end());
    if (!is_file_batch(inputs, request)) {
        if (const Option* option = first_of_groups(request.given, {kManyFilesGroup}))
            throw UsageError(fmt::format("{} is for many files: coppice {} FILES... -o FOLDER", option->name,
                                         command.name));
        return std::nullopt;
    }
    FileBatch batch{.folder = output_folder(request, inputs.front()), .items = {}};
    const std::string pattern = pattern_of(run, command, batch.folder);
    for (const fs::path& input : inputs) {
        if (!is_list(input))
            add_inputs(batch, *command.many, input);
        else
            for (const fs::path& listed : read_list(input)) add_inputs(batch, *command.many, listed);
    }
    if (batch.items.empty())
        throw InvalidInput(fmt::format("'{}' contains no files that coppice {} reads",
                                       inputs.front().string(), command.name));
    name_outputs(batch, pattern);
    return batch;
}

}  // namespace coppice::cli
