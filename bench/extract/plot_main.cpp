// coppice_plot_bench: creates plots of many trees, scans them, segments them with Coppice, and prints the
// quality as Markdown; see docs/user/plots.md.

#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <filesystem>
#include <string>
#include <vector>

#include "clock.h"
#include "coppice/io_points/writer.h"
#include "coppice/io_skeleton/writer.h"
#include "coppice/system/file.h"
#include "machine.h"
#include "plot_bench.h"

namespace {

using namespace coppice;
namespace fs = std::filesystem;

struct Flags {
    std::vector<std::string> plots{"10:1000000", "40:4000000"};
    fs::path folder;
    unsigned threads = 2;
    bool only_segments = false;
};

/// Writes the cloud, the true skeletons, and a table of the trees.
void leave_truth(const bench::PlotScene& scene, const fs::path& folder, const Context& ctx) {
    fs::create_directories(folder);
    std::string name = scene.name;
    std::ranges::replace(name, ':', '_');
    write_points(folder / fmt::format("plot_{}.ply", name), scene.points, ctx);
    std::string table = "tree,x,y,z,dbh,height\n";
    for (std::size_t t = 0; t < scene.trees.size(); ++t) {
        const bench::TrueTree& tree = scene.trees[t];
        write_skeleton(folder / fmt::format("plot_{}_{:03}.truth.swc", name, t + 1), tree.skeleton);
        table += fmt::format("{},{:.3f},{:.3f},{:.3f},{:.4f},{:.3f}\n", t + 1, tree.foot.x, tree.foot.y,
                             tree.foot.z, tree.dbh, tree.height);
    }
    write_file(folder / fmt::format("plot_{}.csv", name), table);
}

PlotExtraction extract(const bench::PlotScene& scene, const Flags& flags, const Context& ctx) {
    if (!flags.only_segments) return extract_plot(scene.points, {}, {}, ctx);
    PlotExtraction out{segment_plot(scene.points, {}, ctx), {}};
    for (const StemForm& form : out.segments.trees) out.trees.push_back({.form = form});
    return out;
}

void run(const Flags& flags) {
    const Context ctx{.threads = flags.threads, .stop = {}, .progress = {}};
    std::vector<bench::PlotScore> scores;
    for (const std::string& name : flags.plots) {
        fmt::print(stderr, "{} ...\n", name);
        const bench::PlotScene scene = bench::make_plot(name, ctx);
        if (!flags.folder.empty()) leave_truth(scene, flags.folder, ctx);
        bench::reset_peak();
        const std::size_t before = bench::resident_bytes();
        const bench::Clock clock;
        const PlotExtraction found = extract(scene, flags, ctx);
        const double seconds = clock.seconds();
        const std::size_t peak = bench::peak_resident_bytes();
        scores.push_back(bench::judge_plot(scene, found));
        scores.back().seconds = seconds;
        scores.back().peak_bytes = peak > before ? peak - before : 0;
    }
    fmt::print("Machine: {}. Threads: {}.\n\n{}", bench::machine_description(), flags.threads,
               bench::plot_markdown(scores));
}

}  // namespace

int main(int argc, char** argv) {
    Flags flags;
    CLI::App app("Measures the segmentation of synthetic plots into trees.");
    app.add_option("plots", flags.plots, "TREES:POINTS")->capture_default_str();
    app.add_option("--folder", flags.folder, "Write clouds and truths to this folder.");
    app.add_option("--threads", flags.threads, "Number of threads; 0 uses all.")->capture_default_str();
    app.add_flag("--segments", flags.only_segments,
                 "Only segment the trees, without extraction of skeletons.");
    CLI11_PARSE(app, argc, argv);
    try {
        run(flags);
    } catch (const std::exception& error) {
        fmt::print(stderr, "coppice_plot_bench: {}\n", error.what());
        return 1;
    }
    return 0;
}
