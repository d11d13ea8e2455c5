// coppice_sketch_bench: draws synthetic trees into two images, with different drawing errors, creates
// skeletons from these sketches, and prints as Markdown their deviation from the trees.

#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>
#include <string>
#include <vector>

#include "clock.h"
#include "coppice/base/kernel/segment_distance.h"
#include "coppice/base/median.h"
#include "coppice/measure/match/skeleton_match.h"
#include "coppice/render/render.h"
#include "coppice/render/silhouette.h"
#include "coppice/skeleton/random_tree.h"
#include "coppice/sketch/draw.h"
#include "coppice/sketch/reconstruct.h"
#include "coppice/sketch/trace/trace.h"
#include "lay_on.h"
#include "machine.h"
#include "messy_strokes.h"
#include "program.h"

namespace {

using namespace coppice;

constexpr double kNear = 1.5;  // [radius] of a node: maximum distance of its branch

struct Flags {
    bench::ProgramFlags program;
    int trees = 20;
    int segments = 256;  ///< of each tree: about 100 branches
    std::vector<double> angles{90, 60, 30, 15};
    double camera_error = 0;      ///< [degrees] rotation of the second camera, and per cent of scale
    bool refine_cameras = false;  ///< requests the correction of the cameras
    int views = 2;                ///< of each tree
    std::vector<int> traced;      ///< segments of trees with silhouettes that are traced instead
};

struct Kind {
    const char* name;
    bench::Mess mess;
};
constexpr Kind kKinds[] = {
    {"clean", {}},
    {"±2 px", {.jitter = 2}},
    {"±2 px, cut", {.jitter = 2, .cut = 0.3}},
    {"±2 px, 5 % wrong", {.jitter = 2, .wrong = 0.05}},
    {"±2 px, 5 % wrong, known", {.jitter = 2, .wrong = 0.05, .known = true}},
    {"±2 px, cut, 5 % wrong", {.jitter = 2, .cut = 0.3, .wrong = 0.05}},
    {"±2 px, cut, 5 % wrong, known", {.jitter = 2, .cut = 0.3, .wrong = 0.05, .known = true}}};

/// Sums over trees.
struct Score {
    double branches = 0, refused = 0, ratio = 0, worst_ratio = 1, tips = 0;
    double near = 0, nodes = 0, off = 0, trees = 0;
    std::vector<double> seconds;
};

double distance_to(const Skeleton& found, Vec3d p) {
    double least = std::numeric_limits<double>::infinity();
    for (const NodeId n : nodes(found)) {
        if (found.is_root(n)) continue;
        const Segment s = found.segment(n);
        const Vec3d a(s.a), d = Vec3d(s.b) - a;
        least = std::min(least, distance(p, a + d * closest_parameter(p, a, d)));
    }
    return least;
}

void judge(const Skeleton& tree, const Skeleton& found, Score& score, const Context& ctx) {
    const SkeletonMatch match = compare(tree, found, {}, ctx);
    score.ratio += match.length.ratio();
    if (std::abs(match.length.ratio() - 1) > std::abs(score.worst_ratio - 1))
        score.worst_ratio = match.length.ratio();
    score.tips += match.tips.percent();
    for (const NodeId n : nodes(tree)) {
        const double off = distance_to(found, Vec3d(tree.position(n))) / double{tree.radius(n)};
        score.near += off <= kNear ? 1 : 0;
        score.off += off;
        score.nodes += 1;
    }
    score.trees += 1;
}

Score measure(const Flags& flags, double degrees, const bench::Mess& mess, const Context& ctx) {
    Score score;
    for (int seed = 1; seed <= flags.trees; ++seed) {
        const auto number = static_cast<std::uint64_t>(seed);
        const Skeleton tree = random_tree(static_cast<std::uint32_t>(flags.segments), number);
        const DrawSketchOptions draw{.angle = static_cast<float>(degrees * std::numbers::pi / 180)};
        Sketch sketch = messed_up(draw_sketch(tree, choose_views(tree, draw), draw), mess, number);
        bench::misplace(sketch.views[1], flags.camera_error, number);
        const bench::Clock clock;
        const SketchResult result =
            reconstruct(sketch, {.refine_cameras = flags.refine_cameras}, "tree", ctx);
        score.seconds.push_back(clock.seconds());
        score.branches += static_cast<double>(sketch.branches.size());
        score.refused += static_cast<double>(std::ranges::count_if(
            result.branches, [](const BranchFit& fit) { return !fit.refused.empty(); }));
        // With wrong cameras the position and size of the whole tree cannot be determined.
        judge(tree, flags.camera_error > 0 ? bench::laid_on(tree, result.skeleton) : result.skeleton, score,
              ctx);
    }
    return score;
}

void run(const Flags& flags) {
    const Context ctx = flags.program.context();
    fmt::print(
        "Machine: {}. Threads: {}. {} trees of {} segments for each line, images of 2000 x 2000 pixels.\n\n",
        bench::machine_description(), flags.program.thread_count(), flags.trees, flags.segments);
    fmt::print(
        "| views apart | strokes | branches | refused | length | worst | nodes within 1.5 r | mean off [r] | "
        "tips | "
        "ms for 100 branches |\n| {} |\n",
        fmt::join(std::vector<std::string>(10, "---"), " | "));
    for (const double degrees : flags.angles) {
        for (const Kind& kind : kKinds) {
            const Score s = measure(flags, degrees, kind.mess, ctx);
            fmt::print(
                "| {:g}° | {} | {:.0f} | {:.0f} | {:.3f} | {:.3f} | {:.1f} % | {:.2f} | {:.1f} % | {:.1f} "
                "|\n",
                degrees, kind.name, s.branches, s.refused, s.ratio / s.trees, s.worst_ratio,
                100 * s.near / s.nodes, s.off / s.nodes, s.tips / s.trees,
                1e5 * median(s.seconds) * s.trees / s.branches);
        }
    }
}

/// Returns the projection of a skeleton by the camera of a view.
Mask seen_by(const Skeleton& tree, const SketchView& view, const Context& ctx) {
    RenderOptions options;
    options.camera.width = view.width;
    options.camera.height = view.height;
    options.samples = 4;
    options.ground = false;
    options.transparent = true;
    return compute_silhouette(render({.skeleton = &tree, .view = &view}, options, ctx));
}

double compute_mean(const std::vector<std::uint32_t>& counts) {
    double sum = 0;
    for (const std::uint32_t n : counts) sum += n;
    return sum / static_cast<double>(counts.size());
}

/// Returns level views around a tree: two at a right angle, more than two evenly over half a turn.
std::vector<SketchView> views_around(const Skeleton& tree, int count) {
    if (count == 2) return choose_views(tree);
    std::vector<SketchView> views{choose_views(tree)[0]};
    for (int v = 1; v < count; ++v) {
        views.push_back(choose_views(tree, {.angle = static_cast<float>(v * std::numbers::pi / count)})[1]);
        views.back().name = fmt::format("view {}", v);
    }
    return views;
}

/// Measures skeletons from strokes that are proposed from silhouettes, without edits.
void run_traces(const Flags& flags) {
    const Context ctx = flags.program.context();
    fmt::print(
        "Machine: {}. Threads: {}. {} trees for each line, silhouettes of 2000 x 2000 pixels in {} "
        "views.\n\n",
        bench::machine_description(), flags.program.thread_count(), flags.trees, flags.views);
    fmt::print("| segments | tips | tips seen | branches proposed | length covered | true | s |\n| {} |\n",
               fmt::join(std::vector<std::string>(7, "---"), " | "));
    for (const int segments : flags.traced) {
        double tips = 0, seen = 0, branches = 0, covered = 0, right = 0;
        std::vector<double> seconds;
        for (int seed = 1; seed <= flags.trees; ++seed) {
            const Skeleton tree =
                random_tree(static_cast<std::uint32_t>(segments), static_cast<std::uint64_t>(seed));
            const std::vector<SketchView> views = views_around(tree, flags.views);
            std::vector<Mask> silhouettes;
            for (const SketchView& view : views) silhouettes.push_back(seen_by(tree, view, ctx));
            const bench::Clock clock;
            const TraceResult traced = trace(views, silhouettes, ctx);
            seconds.push_back(clock.seconds());
            const Skeleton found = reconstruct(traced.sketch, {}, "traced", ctx).skeleton;
            const SkeletonMatch match = compare(tree, found, {}, ctx);
            tips += static_cast<double>(match.tips.reference);
            seen += compute_mean(traced.tips);
            branches += static_cast<double>(traced.sketch.branches.size());
            covered += match.covered_percent;
            right += match.true_percent;
        }
        const double trees = flags.trees;
        fmt::print("| {} | {:.0f} | {:.0f} | {:.1f} | {:.0f} % | {:.0f} % | {:.2f} |\n", segments,
                   tips / trees, seen / trees, branches / trees, covered / trees, right / trees,
                   median(seconds));
    }
}

}  // namespace

int main(int argc, char** argv) {
    Flags flags;
    CLI::App app("Measures the deviation of skeletons created from sketches from the drawn trees.");
    app.add_option("--trees", flags.trees, "Number of synthetic trees for each line.")->capture_default_str();
    app.add_option("--segments", flags.segments, "Number of segments of each tree.")->capture_default_str();
    app.add_option("--angles", flags.angles, "Angles in degrees between the two views.")
        ->capture_default_str();
    app.add_option("--threads", flags.program.threads, "Number of threads; 0 uses all.")
        ->capture_default_str();
    app.add_option(
           "--camera-error", flags.camera_error,
           "Rotation of the second camera in degrees around a random axis, and per cent of its scale.")
        ->capture_default_str();
    app.add_flag("--refine-cameras", flags.refine_cameras, "Correct the cameras.");
    app.add_option("--views", flags.views, "Number of silhouettes of each traced tree.")
        ->capture_default_str();
    app.add_option("--trace", flags.traced,
                   "Numbers of segments of trees with silhouettes that are traced instead of drawn strokes.");
    return bench::run_program(app, argc, argv,
                              [&] { flags.traced.empty() ? run(flags) : run_traces(flags); });
}
