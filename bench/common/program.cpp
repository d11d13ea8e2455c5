#include "program.h"

#include <fmt/format.h>

#include <thread>

#include "coppice/system/file.h"

namespace coppice::bench {
namespace {

void write_text(const std::filesystem::path& path, const std::string& text) {
    if (path.empty()) return;
    write_file(path, text);
}

}  // namespace

unsigned ProgramFlags::thread_count() const {
    return threads == 0 ? std::thread::hardware_concurrency() : threads;
}

void add_program_flags(CLI::App& app, ProgramFlags& flags, int& repeat, double& seconds,
                       const std::string& row) {
    app.add_option("--threads", flags.threads, "Number of threads; 0 uses all.")->capture_default_str();
    app.add_option("--repeat", repeat, "Maximum number of timed runs per " + row)
        ->check(CLI::PositiveNumber)
        ->capture_default_str();
    app.add_option("--seconds", seconds,
                   fmt::format("Maximum time for the timed runs of a {}; at least three are made.", row))
        ->capture_default_str();
    app.add_option("--json", flags.json, "Write all samples to this file.");
    app.add_option("--csv", flags.csv, fmt::format("Write a line per {} and measure to this file.", row));
    app.add_option("--markdown", flags.markdown, "Also write the tables to this file.");
}

void save(const Results& results, const ProgramFlags& flags) {
    write_text(flags.markdown, results.markdown);
    write_text(flags.json, results.json);
    write_text(flags.csv, results.csv);
}

void publish(const Results& results, const ProgramFlags& flags) {
    fmt::print("{}", results.markdown);
    save(results, flags);
}

int run_program(CLI::App& app, int argc, char** argv, const std::function<void()>& run) {
    CLI11_PARSE(app, argc, argv);
    try {
        run();
    } catch (const std::exception& error) {
        fmt::print(stderr, "{}: {}\n", app.get_name(), error.what());
        return 1;
    }
    return 0;
}

}  // namespace coppice::bench
