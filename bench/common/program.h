#pragma once

#include <CLI/CLI.hpp>
#include <filesystem>
#include <functional>
#include <string>

#include "coppice/base/context.h"

namespace coppice::bench {

/// The flags that all programs here take.
struct ProgramFlags {
    unsigned threads = 2;  ///< 0: all
    std::filesystem::path json, csv, markdown;

    Context context() const { return {.threads = threads, .stop = {}, .progress = {}}; }
    unsigned thread_count() const;  ///< with 0 made the machine's number
};

/// The results of a run in all its spellings.
struct Results {
    std::string markdown, json, csv;
};

/// Adds --threads, --repeat, --seconds, --json, --csv and --markdown; `row` is what the program calls one
/// thing that it measures. All arguments must live until the flags are parsed.
void add_program_flags(CLI::App& app, ProgramFlags& flags, int& repeat, double& seconds,
                       const std::string& row);

/// Writes the files that were asked for. Throws IoError.
void save(const Results& results, const ProgramFlags& flags);

/// Prints the tables and writes the files that were asked for. Throws IoError.
void publish(const Results& results, const ProgramFlags& flags);

/// The body of main: parses the flags, runs, and turns an exception into one line and exit code 1.
int run_program(CLI::App& app, int argc, char** argv, const std::function<void()>& run);

}  // namespace coppice::bench
