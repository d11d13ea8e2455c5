// coppice_crown_bench: measures implicit crowns, point sets and growth, and prints Markdown; see
// docs/user/benchmarks.md.

#include "crown_bench.h"
#include "machine.h"
#include "program.h"

namespace {

using namespace coppice;

struct Flags {
    bench::CrownOptions options;
    bench::ProgramFlags program;
    bool small = false;
};

void run(Flags& flags) {
    flags.options.huge = !flags.small;
    const auto rows = bench::bench_crowns(flags.options, flags.program.context());
    const unsigned threads = flags.program.thread_count();
    const std::string machine = bench::machine_description();
    bench::publish({.markdown = bench::crown_markdown(rows, threads, machine),
                    .json = bench::crown_json(rows, threads, machine),
                    .csv = bench::crown_csv(rows, threads)},
                   flags.program);
}

}  // namespace

int main(int argc, char** argv) {
    Flags flags;
    CLI::App app("Measures implicit crowns, point sets and growth.", "coppice_crown_bench");
    app.add_option("--only", flags.options.only, "Measure only rows with this text in their name.");
    app.add_flag("--small", flags.small, "Omit the rows that take seconds.");
    bench::add_program_flags(app, flags.program, flags.options.repeat, flags.options.seconds, "row");
    return bench::run_program(app, argc, argv, [&] { run(flags); });
}
