// coppice_crown_bench: measures implicit crowns, point sets and growth, and prints Markdown; see
// docs/user/benchmarks.md.

#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <filesystem>
#include <string>
#include <thread>

#include "coppice/io/file.h"
#include "crown_bench.h"
#include "machine.h"

namespace {

using namespace coppice;
namespace fs = std::filesystem;

struct Flags {
    bench::CrownOptions options;
    unsigned threads = 2;
    bool small = false;
    fs::path json, csv, markdown;
};

void add_flags(CLI::App& app, Flags& flags) {
    app.add_option("--only", flags.options.only, "rows that have this in their name");
    app.add_option("--threads", flags.threads, "threads to use; 0 takes all")->capture_default_str();
    app.add_option("--repeat", flags.options.repeat, "timed runs per row")
        ->check(CLI::PositiveNumber)
        ->capture_default_str();
    app.add_option("--seconds", flags.options.seconds, "for the timed runs of a row; at least three are made")
        ->capture_default_str();
    app.add_flag("--small", flags.small, "leave out the rows that take seconds");
    app.add_option("--json", flags.json, "write all samples to this file");
    app.add_option("--csv", flags.csv, "write a line per row and measure to this file");
    app.add_option("--markdown", flags.markdown, "write the tables to this file as well");
}

void write_text(const fs::path& path, const std::string& text) {
    if (path.empty()) return;
    AtomicFile file(path);
    file.write(text);
    file.commit();
}

void run(Flags& flags) {
    flags.options.huge = !flags.small;
    const Context ctx{.threads = flags.threads, .stop = {}, .progress = {}};
    const auto rows = bench::bench_crowns(flags.options, ctx);
    const unsigned threads = flags.threads == 0 ? std::thread::hardware_concurrency() : flags.threads;
    const std::string machine = bench::machine_description();
    const std::string tables = bench::crown_markdown(rows, threads, machine);
    fmt::print("{}", tables);
    write_text(flags.markdown, tables);
    write_text(flags.json, bench::crown_json(rows, threads, machine));
    write_text(flags.csv, bench::crown_csv(rows, threads));
}

}  // namespace

int main(int argc, char** argv) {
    Flags flags;
    CLI::App app("Measures implicit crowns, point sets and growth");
    add_flags(app, flags);
    CLI11_PARSE(app, argc, argv);
    try {
        run(flags);
    } catch (const std::exception& error) {
        fmt::print(stderr, "coppice_crown_bench: {}\n", error.what());
        return 1;
    }
    return 0;
}
