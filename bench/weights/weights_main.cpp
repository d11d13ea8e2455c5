// coppice_weights_bench: compares local with global weights, and measures the solver; prints Markdown.

#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <string>
#include <vector>

#include "weights_bench.h"

int main(int argc, char** argv) {
    using namespace coppice;
    std::vector<std::string> scenes{"chain", "Y", "tree300"};
    unsigned threads = 2;
    int repeat = 5;
    bool surfaces_only = false;
    CLI::App app("Measures local and global weights.");
    app.add_option("scenes", scenes, "Scenes: chain, Y, synthetic trees or skeleton files.")
        ->capture_default_str();
    app.add_option("--threads", threads, "Number of threads; 0 uses all.")->capture_default_str();
    app.add_option("--repeat", repeat, "Number of timed runs.")
        ->check(CLI::PositiveNumber)
        ->capture_default_str();
    app.add_flag("--surfaces-only", surfaces_only, "Omit the times of the solver.");
    CLI11_PARSE(app, argc, argv);
    try {
        const Context ctx{.threads = threads, .stop = {}, .progress = {}};
        fmt::print("{}", bench::weights_markdown(bench::bench_weights(scenes, repeat, ctx)));
        if (!surfaces_only) fmt::print("\n{}", bench::nnls_markdown(bench::bench_nnls(repeat, ctx)));
    } catch (const std::exception& error) {
        fmt::print(stderr, "coppice_weights_bench: {}\n", error.what());
        return 1;
    }
    return 0;
}
