#pragma once

#include <cstddef>
#include <filesystem>
#include <optional>
#include <vector>

#include "parser.h"
#include "run.h"

namespace coppice::cli {

/// One file of a batch.
struct BatchItem {
    std::filesystem::path input;
    std::filesystem::path output;
};

/// Many files, each of which is processed by itself by the same command.
struct FileBatch {
    std::filesystem::path folder;  ///< output folder
    std::vector<BatchItem> items;
    std::size_t passed_over = 0;  ///< number of files in the folders that the command does not read
};

/// Returns the files of a command line: several inputs of a command that takes one, a folder, a list
/// (`@files.txt`, or `-` for standard input), or any input if the output is a folder; nullopt for a single
/// file. Throws UsageError if the command writes several files, two files would write the same output, or an
/// output would overwrite an input; InvalidInput if there are no files; IoError if a list cannot be read.
std::optional<FileBatch> plan_file_batch(const Run& run, const Parser::Request& request);

/// Returns the option with this name. The command has it.
const Option& find_option(const Command& command, std::string_view name);

}  // namespace coppice::cli
