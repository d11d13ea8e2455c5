// coppice_live_bench: makes random edits of one tree with a live surface, and prints as Markdown the cost of
// each kind; at regular intervals the surface is compared with one made from scratch.

#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <algorithm>
#include <string>
#include <vector>

#include "clock.h"
#include "coppice/base/error.h"
#include "coppice/base/median.h"
#include "coppice/edit/rigid.h"
#include "coppice/pipeline/live_surface.h"
#include "machine.h"
#include "program.h"
#include "random_edits.h"

namespace {

using namespace coppice;

struct Flags : bench::EditFlags {
    int check = 0;
    unsigned subtree = 0;
    MeshOptions options;
};

bool is_same(const QuadMesh& a, const QuadMesh& b) {
    return std::ranges::equal(a.positions, b.positions) && std::ranges::equal(a.quads, b.quads);
}

// Returns a node with about this number of descendants.
StableId node_with(const EditableTree& tree, bench::Dice& dice, std::size_t nodes) {
    StableId best = dice.node(tree);
    std::size_t least = tree.size();
    for (int i = 0; i < 400; ++i) {
        const StableId n = dice.node(tree);
        const std::size_t size = tree.subtree(n).size(), off = size > nodes ? size - nodes : nodes - size;
        if (off < least) {
            least = off;
            best = n;
        }
    }
    return best;
}

struct Costs {
    std::string name;
    std::vector<double> surface, meshed, vertices;
    int whole = 0;
};

double most(const std::vector<double>& all) { return all.empty() ? 0 : *std::ranges::max_element(all); }

void follow(LiveSurface& surface, const EditableTree& tree, const EditChange& change, Costs& costs,
            const Context& ctx) {
    const bench::Clock clock;
    const SurfaceChange wrote = surface.update(tree.skeleton(), change.nodes(), ctx);
    costs.surface.push_back(clock.seconds());
    costs.meshed.push_back(wrote.meshed);
    double vertices = 0;
    for (const NumberRange& r : wrote.vertices) vertices += r.count;
    costs.vertices.push_back(vertices);
    costs.whole += wrote.is_whole ? 1 : 0;
}

void run(const Flags& flags) {
    const Skeleton first = flags.skeleton();
    EditableTree tree(first);
    bench::Dice dice(flags.seed);
    std::vector<bench::Kind> kinds = bench::all_kinds();
    if (flags.subtree > 0) {
        kinds.resize(1);
        kinds[0] = {.name = "rotate a subtree",
                    .edit =
                        [&](EditableTree& t, bench::Dice& d) {
                            return rotate(t, {node_with(t, d, flags.subtree)},
                                          {.angle = d.uniform(-0.3, 0.3)});
                        },
                    .seconds = {}};
    }
    std::vector<Costs> costs(kinds.size());
    const Context ctx{.threads = flags.program.threads};
    const bench::Clock whole_clock;
    LiveSurface surface(tree.skeleton(), flags.options, ctx);
    const double whole = whole_clock.seconds();
    int compared = 0, different = 0;
    for (int i = 0; i < flags.edits; ++i) {
        const std::size_t k = dice.below(kinds.size());
        costs[k].name = kinds[k].name;
        try {
            const EditChange change = kinds[k].edit(tree, dice);
            follow(surface, tree, change, costs[k], ctx);
        } catch (
            const InvalidInput&) {  // invalid edits, such as an axis of one segment or a graft into itself
            continue;
        }
        if (flags.check > 0 && i % flags.check == 0) {
            ++compared;
            if (!is_same(surface.mesh(), LiveSurface(tree.skeleton(), flags.options, ctx).mesh())) {
                ++different;
                fmt::print(stderr, "after edit {} ({}) the surface differs from one made from scratch\n", i,
                           kinds[k].name);
                surface = LiveSurface(tree.skeleton(), flags.options, ctx);
            }
        }
        // Undoes the edit, so that every edit starts from the same tree.
        if (flags.subtree > 0) follow(surface, tree, tree.undo(), costs[k], ctx);
    }
    std::string out = fmt::format(
        "{}\n\n{} nodes; the whole surface: {:.1f} ms\n\n| edit | times | of these whole | nodes meshed, "
        "median | "
        "vertices "
        "written, median | median ms | slowest ms |\n| --- | --: | --: | --: | --: | --: | --: |\n",
        bench::machine_description(), first.size(), 1e3 * whole);
    for (Costs& c : costs) {
        if (c.surface.empty()) continue;
        out += fmt::format("| {} | {} | {} | {:.0f} | {:.0f} | {:.2f} | {:.1f} |\n", c.name, c.surface.size(),
                           c.whole, median(c.meshed), median(c.vertices), 1e3 * median(c.surface),
                           1e3 * most(c.surface));
    }
    if (compared > 0)
        out += fmt::format("\n{} surfaces compared with surfaces made from scratch: {} differ\n", compared,
                           different);
    bench::publish({.markdown = out, .json = {}, .csv = {}}, flags.program);
    if (different > 0) throw Error("surfaces differ from those made from scratch");
}

}  // namespace

int main(int argc, char** argv) {
    CLI::App app("Measures the costs of surfaces that follow edits.");
    Flags flags;
    flags.segments = 3'000;
    flags.edits = 200;
    bench::add_edit_flags(app, flags);
    app.add_option("--check", flags.check,
                   "Number of edits between comparisons with a surface made from scratch.");
    app.add_option("--subtree", flags.subtree, "Only turn subtrees of about this number of nodes.");
    app.add_option("--remesh-rounds", flags.options.remesh_rounds,
                   "Maximum number of remeshing rounds, as in coppice mesh.");
    app.add_option("--threads", flags.program.threads, "0: all");
    return coppice::bench::run_program(app, argc, argv, [&] { run(flags); });
}
