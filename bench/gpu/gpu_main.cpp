// coppice_gpu_bench: measures the time and memory of surfaces on a GPU, compared with the CPU of the same
// machine and with published values. Without a GPU only the CPU is measured.

#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <algorithm>
#include <iterator>
#include <utility>

#include "coppice/base/error.h"
#include "coppice/io_skeleton/writer.h"
#include "coppice/pipeline/mesh_skeleton.h"
#include "coppice/skeleton/random_tree.h"
#include "gpu_pairs.h"
#include "gpu_quads.h"
#include "gpu_tetra.h"
#include "machine.h"
#include "program.h"
#include "routes_papers.h"

namespace {

using namespace coppice;
using namespace coppice::bench;

struct Flags : ProgramFlags {
    int repeat = 51;
    double seconds = 10;
    bool small = false;
    std::filesystem::path tree;
};

constexpr std::uint64_t kSeed = 1;

using Stages = std::vector<std::pair<std::string, double>>;

/// Returns the published time of all stages except the first ones, which run on the CPU.
double printed(const Stages& stages, std::ptrdiff_t on_cpu) {
    double sum = 0;
    for (auto stage = stages.begin() + on_cpu; stage != stages.end(); ++stage) sum += stage->second;
    return sum;
}

/// Returns the trees of [Zhu2015].
std::vector<QuadCase> printed_quad_cases() {
    constexpr std::ptrdiff_t kOnCpu = 1;  // the polyhedron
    std::vector<QuadCase> out;
    for (const PaperTree& tree : paper_trees()) {
        if (tree.quads.empty()) continue;
        out.push_back({tree.name,
                       {random_tree(tree.segments, kSeed)},
                       printed(tree.quads[0].stages, kOnCpu),
                       {{GoalKind::card, 0.15}},
                       true});
    }
    return out;
}

QuadCase tree30k() {
    return {"tree30k",
            {random_tree(30'000, kSeed)},
            -1,
            {{GoalKind::card, 1}, {GoalKind::cage, 20}, {GoalKind::speedup, 10}}};
}
QuadCase tree300k() {
    return {"tree300k", {random_tree(300'000, kSeed)}, -1, {{GoalKind::card, 8}, {GoalKind::memory, 80}}};
}
QuadCase different_trees(std::string name, std::uint64_t trees, std::uint32_t segments, double goal) {
    QuadCase out{std::move(name), {}, -1, {{GoalKind::card, goal}}};
    for (std::uint64_t i = 0; i < trees; ++i) out.trees.push_back(random_tree(segments, kSeed + i));
    return out;
}

/// Returns the trees of [Zhu2013], in its polyhedron.
std::vector<TetraCase> printed_tetra_cases() {
    constexpr std::ptrdiff_t kOnCpu = 2;  // the polyhedron and its tetrahedra
    std::vector<TetraCase> out;
    for (const PaperTree& tree : paper_trees()) {
        if (tree.paper != "Zhu2013") continue;
        out.push_back({tree.name,
                       random_tree(tree.segments, kSeed),
                       true,
                       TetraOptions{}.edge,
                       3,
                       printed(tree.tetrahedra.stages, kOnCpu),
                       {{GoalKind::card, 0.5}}});
    }
    return out;
}

/// Returns a case with the resolution of the quads: with this edge there are two triangles for each quad.
TetraCase fine_tetra_case() {
    return {"tree30k", random_tree(30'000, kSeed), false, 0.87f, 2, -1, {{GoalKind::card, 12}}};
}

std::string describe(const DeviceSearch& search) {
    if (!search.device) return fmt::format("no GPU: {}", search.missing);
    const DeviceInfo& card = *search.device;
    return fmt::format("{}, capability {}.{}, {} multiprocessors, {:.1f} Tflop/s, {:.2f} TB/s", card.name,
                       card.compute / 10, card.compute % 10, card.multiprocessors, 1e-12 * card.flops,
                       1e-12 * card.bandwidth);
}

/// Runs the cases. All files are written after each case, so that an interrupted run, or a GPU failure, loses
/// no results.
class Bench {
  public:
    explicit Bench(const Flags& flags)
        : flags_(flags), run_{find_device(), flags.repeat, flags.seconds, flags.context()} {}

    void quads(const QuadCase& c) {
        attempt(c.name, [&] { std::ranges::move(measure_quads(c, run_), std::back_inserter(surfaces_)); });
    }
    void printed_tetra(const TetraCase& c) {
        attempt(c.name, [&] { surfaces_.push_back(measure_printed_tetra(c, run_)); });
    }
    void tetra(const TetraCase& c) {
        attempt(c.name, [&] { surfaces_.push_back(measure_tetra(c, run_)); });
    }
    void pairs(Kernel kernel) {
        attempt("pairs", [&] { pairs_.push_back(measure_pairs(kernel, run_)); });
    }
    void finish() const { publish(results(), flags_); }

  private:
    template <class Work>
    void attempt(const std::string& name, const Work& work) {
        try {
            work();
        } catch (const Error& error) {
            failures_.push_back(fmt::format("{}: {}", name, error.what()));
        }
        save(results(), flags_);
    }

    Results results() const {
        const std::string card = describe(run_.device);
        Json json{{"machine", machine_description()}, {"card", card}};
        for (const std::string& failure : failures_) json["failures"].push_back(failure);
        for (const GpuResult& r : surfaces_) json["surfaces"].push_back(make_json(r, run_.device));
        for (const PairsResult& r : pairs_) json["pairs"].push_back(make_json(r, run_.device));
        std::string markdown = fmt::format("Measured on: {}; {}.\n\n", machine_description(), card);
        for (const std::string& failure : failures_)
            markdown += fmt::format("Not measured: {}.\n\n", failure);
        markdown += to_markdown(surfaces_, run_.device) + "\n" + to_markdown(pairs_, run_.device);
        return {markdown, json.dump(1) + "\n", {}};
    }

    const Flags& flags_;
    GpuRun run_;
    std::vector<GpuResult> surfaces_;
    std::vector<PairsResult> pairs_;
    std::vector<std::string> failures_;
};

void measure(const Flags& flags) {
    if (!flags.tree.empty()) return write_skeleton(flags.tree, random_tree(3000, kSeed));
    Bench bench(flags);
    for (const QuadCase& c : printed_quad_cases()) bench.quads(c);
    if (!flags.small) bench.quads(tree30k());
    for (const TetraCase& c : printed_tetra_cases()) bench.printed_tetra(c);
    bench.pairs(Kernel::quartic);
    bench.pairs(Kernel::cauchy);
    if (!flags.small) {
        bench.tetra(fine_tetra_case());
        bench.quads(tree300k());
        bench.quads(different_trees("1,000 trees of 300", 1000, 300, 15));
        bench.quads(different_trees("100 trees of 10,000", 100, 10'000, 100));
    }
    bench.finish();
}

}  // namespace

int main(int argc, char** argv) {
    Flags flags;
    flags.threads = 0;
    CLI::App app("Measures surfaces on a GPU.");
    add_program_flags(app, flags, flags.repeat, flags.seconds, "case");
    app.add_flag("--small", flags.small, "Measure only the trees of the papers.");
    app.add_option("--write-tree", flags.tree, "Only write a synthetic tree of 3,000 segments to this file.");
    return run_program(app, argc, argv, [&] { measure(flags); });
}
