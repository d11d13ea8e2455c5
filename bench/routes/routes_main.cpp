// coppice_comparison: compares quads, tetrahedra and uniform grids with each other and with published values;
// see docs/user/comparison.md.

#include <fmt/format.h>

#include "machine.h"
#include "program.h"
#include "routes_report.h"

namespace {

using namespace coppice;

struct Flags {
    std::vector<std::string> scenes{"tree300", "tree300hard", "tree3k", "tree3khard", "tree30k"};
    std::string twigs = "tree3k";
    bench::RoutesOptions options;
    bench::ProgramFlags program;
    std::string only;
    bool small = false;
};

/// Returns trees of a few segments with few triangles, to test that everything runs.
void make_small(Flags& flags) {
    constexpr std::uint32_t kShrink = 8;
    flags.scenes = {"tree300"};
    flags.twigs = "tree300";
    flags.options.brute_seconds = 0;
    flags.options.shrink = kShrink;
}

void measure(const Flags& flags, bench::Comparison& all, const Context& ctx) {
    const auto wanted = [&](const char* part) { return flags.only.empty() || flags.only == part; };
    if (wanted("papers")) {
        all.papers = bench::paper_trees();
        for (const bench::PaperTree& tree : all.papers) {
            fmt::print(stderr, "{} ...\n", tree.name);
            all.paper_trees.push_back(bench::compare_paper(tree, flags.options, ctx));
        }
    }
    if (wanted("routes")) {
        for (const std::string& scene : flags.scenes) {
            fmt::print(stderr, "{} ...\n", scene);
            all.scenes.push_back(bench::compare_routes(bench::make_scene(scene), flags.options, ctx));
        }
    }
    if (wanted("twigs")) {
        fmt::print(stderr, "twigs of {} ...\n", flags.twigs);
        all.twigs = bench::compare_twigs(bench::make_scene(flags.twigs), flags.options, ctx);
    }
}

void run(Flags& flags) {
    if (flags.small) make_small(flags);
    if (!flags.options.pictures.empty()) std::filesystem::create_directories(flags.options.pictures);
    bench::Comparison all{.machine = bench::machine_description(), .threads = flags.program.thread_count()};
    measure(flags, all, flags.program.context());
    bench::publish({.markdown = bench::comparison_markdown(all),
                    .json = bench::comparison_json(all),
                    .csv = bench::comparison_csv(all)},
                   flags.program);
}

}  // namespace

int main(int argc, char** argv) {
    Flags flags;
    CLI::App app("Compares quads, tetrahedra and uniform grids with each other and with the papers.",
                 "coppice_comparison");
    app.add_option("scenes", flags.scenes,
                   "Synthetic trees by name (tree30k, tree3khard, ...) or skeleton files.");
    app.add_option("--twigs", flags.twigs, "Tree for the coarsest grid that shows every twig.")
        ->capture_default_str();
    app.add_option("--brute-seconds", flags.options.brute_seconds,
                   "Maximum time per grid for the field of every segment at every corner.")
        ->capture_default_str();
    app.add_option("--pictures", flags.options.pictures, "Draw all surfaces into this folder.");
    app.add_option("--only", flags.only, "Run only one part of the comparison.")
        ->check(CLI::IsMember({"papers", "routes", "twigs"}));
    app.add_flag("--small", flags.small, "Use only small trees, to test the program.");
    bench::add_program_flags(app, flags.program, flags.options.repeat, flags.options.seconds, "route");
    return bench::run_program(app, argc, argv, [&] { run(flags); });
}
