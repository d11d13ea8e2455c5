// coppice_leaves_bench: scans synthetic trees with leaves, extracts skeletons from the clouds, and prints as
// Markdown the share of points that are classified correctly as leaf or wood, and the effect on the skeleton.

#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <algorithm>
#include <cstdlib>
#include <string>
#include <thread>
#include <vector>

#include "clock.h"
#include "coppice/base/error.h"
#include "coppice/extract/cloud/from_cloud.h"
#include "coppice/measure/match/skeleton_match.h"
#include "leafy_tree.h"
#include "machine.h"
#include "scenes.h"

namespace {

using namespace coppice;

struct Flags {
    std::vector<std::string> scenes{"tree3k:none:100000",   "tree3k:sparse:25000", "tree3k:sparse:100000",
                                    "tree3k:sparse:400000", "tree3k:usual:25000",  "tree3k:usual:100000",
                                    "tree3k:usual:400000",  "tree3k:dense:25000",  "tree3k:dense:100000",
                                    "tree3k:dense:400000"};
    unsigned threads = 0;
};

/// Counts of points by actual and predicted class.
struct ClassCounts {
    double wood_as_wood = 0, wood_as_leaf = 0, leaf_as_wood = 0, leaf_as_leaf = 0;

    double all() const { return wood_as_wood + wood_as_leaf + leaf_as_wood + leaf_as_leaf; }
    double found() const { return (wood_as_leaf + leaf_as_leaf) / all(); }
    double overall() const { return (wood_as_wood + leaf_as_leaf) / all(); }
    double wood_recall() const { return wood_as_wood / std::max(wood_as_wood + wood_as_leaf, 1.0); }
    double wood_precision() const { return wood_as_wood / std::max(wood_as_wood + leaf_as_wood, 1.0); }
    double leaf_recall() const { return leaf_as_leaf / std::max(leaf_as_wood + leaf_as_leaf, 1.0); }
    double f1() const {
        return 2 * wood_recall() * wood_precision() / std::max(wood_recall() + wood_precision(), 1e-9);
    }
};

bool before(Vec3 a, Vec3 b) { return a.x != b.x ? a.x < b.x : a.y != b.y ? a.y < b.y : a.z < b.z; }

ClassCounts compare_points(const bench::LeafyScan& scan, const PointSet& found) {
    std::vector<Vec3> leaves(found.positions.begin(), found.positions.end());
    std::ranges::sort(leaves, before);
    ClassCounts counts;
    for (std::size_t i = 0; i < scan.leaf.size(); ++i) {
        const bool as_leaf = std::ranges::binary_search(leaves, scan.points.positions[i], before);
        ++(scan.leaf[i] ? (as_leaf ? counts.leaf_as_leaf : counts.leaf_as_wood)
                        : (as_leaf ? counts.wood_as_leaf : counts.wood_as_wood));
    }
    return counts;
}

PointSet select_wood(const bench::LeafyScan& scan) {
    PointSet wood{{}, scan.points.origin};
    for (std::size_t i = 0; i < scan.leaf.size(); ++i) {
        if (!scan.leaf[i]) wood.positions.push_back(scan.points.positions[i]);
    }
    return wood;
}

/// Formats "0.57, 51 %": the ratio of the extracted to the true length, and the share of it on true wood.
std::string judged(const Skeleton& truth, const Skeleton& found, const Context& ctx) {
    const SkeletonMatch m = compare(truth, found, {}, ctx);
    return fmt::format("{:.2f}, {:.0f} %", m.length.ratio(), m.true_percent);
}

void run_scene(const std::string& name, const Context& ctx) {
    const std::size_t second = name.rfind(':'), first = second == 0 ? 0 : name.rfind(':', second - 1);
    if (first == name.npos || second == name.npos)
        throw InvalidInput(fmt::format("'{}' is not a scene; write TREE:FOLIAGE:POINTS", name));
    const bench::Scene scene = bench::make_scene(name.substr(0, first));
    const bench::Foliage foliage = bench::foliage_named(name.substr(first + 1, second - first - 1));
    const int points = std::atoi(name.c_str() + second + 1);
    const bench::LeafyScan scan = bench::scan_leafy_tree(scene.skeleton, foliage, points, ctx);
    const bench::Clock clock;
    const CloudExtraction separated = extract_from_cloud(scan.points, {}, ctx);
    const double seconds = clock.seconds();
    const CloudExtraction kept = extract_from_cloud(scan.points, {.leaves = LeafRule::keep}, ctx);
    const CloudExtraction ideal = extract_from_cloud(select_wood(scan), {.leaves = LeafRule::keep}, ctx);
    const ClassCounts t = compare_points(scan, separated.leaves);
    const bool leafy = scan.leaf_share() > 0;
    fmt::print(
        "| {} | {} | {:.3f} | {:.3f} | {:.3f} | {} | {:.3f} | {:.3f} | {:.3f} | {} | {} | {} | {:.2f} |\n",
        name, scan.points.size(), scan.leaf_share(), t.found(), t.overall(),
        leafy ? fmt::format("{:.3f}", (t.wood_recall() + t.leaf_recall()) / 2) : "", t.wood_recall(),
        t.wood_precision(), t.f1(), judged(scene.skeleton, kept.skeleton, ctx),
        judged(scene.skeleton, separated.skeleton, ctx), judged(scene.skeleton, ideal.skeleton, ctx),
        seconds);
}

void run(const Flags& flags) {
    const Context ctx{.threads = flags.threads, .stop = {}, .progress = {}};
    const unsigned threads = flags.threads == 0 ? std::thread::hardware_concurrency() : flags.threads;
    fmt::print(
        "Machine: {}. Threads: {}. Ratio of extracted to true length, and share of it on true wood: with all "
        "points, without points classified as leaves, without the leaves.\n\n",
        bench::machine_description(), threads);
    fmt::print(
        "| scene | points | leaves | classified | overall | balanced | wood recall | wood precision | wood "
        "F1 | all | classified | ideal | s |\n| {} |\n",
        fmt::join(std::vector<std::string>(13, "---"), " | "));
    for (const std::string& name : flags.scenes) run_scene(name, ctx);
}

}  // namespace

int main(int argc, char** argv) {
    Flags flags;
    CLI::App app("Measures the classification of leaves and wood in scans of synthetic trees.");
    app.add_option("scenes", flags.scenes,
                   "Scenes TREE:FOLIAGE:POINTS: tree300, tree3k, ..., or a skeleton file; none, sparse, "
                   "usual or dense.")
        ->capture_default_str();
    app.add_option("--threads", flags.threads, "Number of threads; 0 uses all.")->capture_default_str();
    CLI11_PARSE(app, argc, argv);
    try {
        run(flags);
    } catch (const std::exception& error) {
        fmt::print(stderr, "coppice_leaves_bench: {}\n", error.what());
        return 1;
    }
    return 0;
}
