#pragma once

#include <CLI/CLI.hpp>
#include <filesystem>
#include <functional>
#include <string>

#include "coppice/base/context.h"

namespace coppice::bench {

/// Flags that all benchmark programs support.
struct ProgramFlags {
    unsigned threads = 2;  ///< 0: all
    std::filesystem::path json, csv, markdown;

    Context context() const { return {.threads = threads, .stop = {}, .progress = {}}; }
    unsigned thread_count() const;  ///< replaces 0 by the number of threads of the machine
};

/// The results of a run in all formats.
struct Results {
    std::string markdown, json, csv;
};

/// Adds --threads, --repeat, --seconds, --json, --csv and --markdown; `row` is the program's name for one
/// measured item. All arguments must live until the flags are parsed.
void add_program_flags(CLI::App& app, ProgramFlags& flags, int& repeat, double& seconds,
                       const std::string& row);

/// Writes the requested files. Throws IoError.
void save(const Results& results, const ProgramFlags& flags);

/// Prints the tables and writes the requested files. Throws IoError.
void publish(const Results& results, const ProgramFlags& flags);

/// The body of main: parses the flags, runs, and converts an exception to one line and exit code 1.
int run_program(CLI::App& app, int argc, char** argv, const std::function<void()>& run);

}  // namespace coppice::bench
