// coppice_animate_bench: sways a tree in the wind and turns its branches to and fro, and prints as Markdown
// the cost of a frame and the number of faces that fold or intersect, with and without holding.

#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <algorithm>
#include <cmath>
#include <numbers>
#include <string>
#include <vector>

#include "clock.h"
#include "coppice/base/median.h"
#include "coppice/edit/animate/wind.h"
#include "coppice/io_skeleton/reader.h"
#include "coppice/mesh/shape.h"
#include "coppice/pipeline/deform/valid_frames.h"
#include "coppice/skeleton/random_tree.h"
#include "machine.h"
#include "program.h"

namespace {

using namespace coppice;

struct Flags {
    bench::ProgramFlags program;
    std::vector<std::string> trees;
    unsigned segments = 3000;
    int frames = 240;
    float wind = 12, flexibility = 1;
    double turn = 0;  // [degrees]
};

// Returns all branches of the first order turned around the vertical through their joints, by an angle.
Pose turned(const Skeleton& s, double angle) {
    Pose out = rest_pose(s);
    const Rotation turn = rotation_about({0, 0, 1}, angle);
    std::vector<std::uint8_t> is_turned(s.size());
    for (const NodeId n : nodes(s)) {
        const NodeId parent = s.parent(n);
        if (!parent) continue;
        const std::uint32_t i = n.index(), p = parent.index();
        is_turned[i] = is_turned[p] != 0 || s.leader(parent) != n ? 1 : 0;
        const Vec3d way = Vec3d(s.position(n)) - Vec3d(s.position(parent));
        out.positions[i] = Vec3(Vec3d(out.positions[p]) + (is_turned[i] != 0 ? turn(way) : way));
        if (is_turned[i] != 0) out.turns[i] = turn;
    }
    return out;
}

struct Figures {
    std::vector<double> seconds;
    std::uint64_t folded = 0, crossings = 0, inverted = 0, unconverged = 0;
    int frozen = 0, whole = 0;
    std::uint32_t max_frozen = 0;
};

std::string row(const Flags& flags, const std::string& name, const Skeleton& tree) {
    const Context ctx = flags.program.context();
    const bench::Clock making;
    SkinnedMesh mesh(tree, {}, ctx);
    const double made = making.seconds();
    constexpr double kPeriod = 10;
    const WindOptions options{.speed = flags.wind, .flexibility = flags.flexibility};
    const Wind wind(tree, options, kPeriod, flags.frames / 8);
    ValidFrames frames(mesh);
    const auto pose_at = [&](double part) {
        const double angle = flags.turn * std::numbers::pi / 180 * std::sin(2 * std::numbers::pi * part);
        const Pose still = flags.turn != 0 ? turned(tree, angle) : rest_pose(tree);
        return wind.swayed(still, part * kPeriod);
    };
    frames.next(pose_at(0), ctx);  // the way from rest to the first frame is not counted
    Figures f;
    for (int i = 0; i < flags.frames; ++i) {
        const double part = static_cast<double>(i) / flags.frames;
        const bench::Clock clock;
        const ValidFrame frame = frames.next(pose_at(part), ctx);
        f.seconds.push_back(clock.seconds());
        f.folded += frame.folded;
        f.crossings += frame.crossings;
        f.unconverged += frame.not_converged;
        f.frozen += frame.is_frozen() ? 1 : 0;
        f.whole += frame.whole_tree_frozen ? 1 : 0;
        f.max_frozen = std::max(f.max_frozen, frame.frozen_nodes);
        QuadMesh now = mesh.made().quads().mesh;
        now.positions = frame.positions;
        f.inverted += shape(now, ctx).inverted_faces;
    }
    return fmt::format(
        "| {} | {} | {} | {:.0f} | {:.1f} | {:.1f} | {:.1f} | {} | {} | {} | {} | {} | {} | {} |\n", name,
        tree.size(), mesh.made().quads().mesh.quads.size(), 1e3 * made, 1e3 * median(f.seconds),
        1e3 * *std::ranges::min_element(f.seconds), 1e3 * *std::ranges::max_element(f.seconds), f.folded,
        f.crossings, f.frozen, f.whole, f.max_frozen, f.inverted, f.unconverged);
}

void run(const Flags& flags) {
    std::string out = fmt::format(
        "{}\n\n{} frames, {} m/s, flexibility {}, branches turned by {} degrees\n\n| tree | nodes | quads | "
        "made, ms "
        "| frame, ms | least | slowest | would fold | would cross | frames frozen | wholly | most nodes "
        "frozen | "
        "folded "
        "| off the "
        "field |\n"
        "| --- | --: | --: | --: | --: | --: | --: | --: | --: | --: | --: | --: | --: | --: |\n",
        bench::machine_description(), flags.frames, flags.wind, flags.flexibility, flags.turn);
    if (flags.trees.empty()) out += row(flags, "made up", random_tree(flags.segments, 1));
    for (const std::string& tree : flags.trees) {
        out += row(flags, std::filesystem::path(tree).stem().string(), read_skeleton(tree).skeleton);
    }
    bench::publish({.markdown = out, .json = {}, .csv = {}}, flags.program);
}

}  // namespace

int main(int argc, char** argv) {
    CLI::App app("Measures the costs of frames of swaying trees.");
    Flags flags;
    app.add_option("trees", flags.trees, "Skeletons to animate instead of a synthetic tree.");
    app.add_option("--segments", flags.segments, "Number of segments of the synthetic tree.");
    app.add_option("--frames", flags.frames, "how many");
    app.add_option("--wind", flags.wind, "Wind speed in metres per second.");
    app.add_option("--flexibility", flags.flexibility, "Flexibility as a multiple of that of green wood.");
    app.add_option("--turn", flags.turn,
                   "Maximum angle in degrees of the oscillation of branches of the first order.");
    app.add_option("--threads", flags.program.threads, "0: all");
    app.add_option("--markdown", flags.program.markdown, "Also write the table to this file.");
    return coppice::bench::run_program(app, argc, argv, [&] { run(flags); });
}
