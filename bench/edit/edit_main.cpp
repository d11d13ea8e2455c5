// coppice_edit_bench: makes thousands of random edits of one tree, undoes all of them, and prints as Markdown
// the cost of each kind, of undoing, and the memory of the history.

#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <algorithm>
#include <cmath>
#include <functional>
#include <string>
#include <vector>

#include "clock.h"
#include "coppice/base/error.h"
#include "coppice/base/median.h"
#include "machine.h"
#include "program.h"
#include "random_edits.h"

namespace {

using namespace coppice;
using bench::Dice;
using bench::Kind;

double milliseconds(std::vector<double> seconds, bool most) {
    if (seconds.empty()) return 0;
    return 1e3 * (most ? *std::ranges::max_element(seconds) : median(seconds));
}

double touched(const EditChange& c) {
    return static_cast<double>(c.added.size() + c.removed.size() +
                               std::max(c.moved.size(), c.resized.size()) + c.reparented.size());
}

bool is_same(const Skeleton& a, const Skeleton& b) {
    return std::ranges::equal(a.parents(), b.parents()) && std::ranges::equal(a.positions(), b.positions()) &&
           std::ranges::equal(a.radii(), b.radii());
}

void run(const bench::EditFlags& flags) {
    const Skeleton first = flags.skeleton();
    EditableTree tree(first);
    Dice dice(flags.seed);
    std::vector<Kind> kinds = bench::all_kinds();
    const std::size_t before = bench::resident_bytes();
    for (int i = 0; i < flags.edits; ++i) {
        Kind& kind = kinds[dice.below(kinds.size())];
        const bench::Clock clock;
        try {
            const double nodes = touched(kind.edit(tree, dice));
            kind.seconds.push_back(clock.seconds());
            kind.nodes += nodes;
            kind.max_nodes = std::max(kind.max_nodes, nodes);
        } catch (
            const InvalidInput&) {  // invalid edits, such as an axis of one segment or a graft into itself
        }
    }
    const std::size_t after = bench::resident_bytes();
    const auto steps = static_cast<double>(tree.undo_depth());
    const double history = static_cast<double>(tree.history_bytes());
    std::vector<double> undo;
    while (tree.undo_depth() > 0) {
        const bench::Clock clock;
        tree.undo();
        undo.push_back(clock.seconds());
    }
    std::string out = fmt::format(
        "{}\n\n| edit | times | nodes touched, mean | most | median ms | slowest ms |\n| --- | --: | --: | "
        "--: | --: | --: |\n",
        bench::machine_description());
    for (const Kind& k : kinds) {
        out += fmt::format("| {} | {} | {:.1f} | {:.0f} | {:.4f} | {:.2f} |\n", k.name, k.seconds.size(),
                           k.nodes / std::max<double>(1, static_cast<double>(k.seconds.size())), k.max_nodes,
                           milliseconds(k.seconds, false), milliseconds(k.seconds, true));
    }
    out += fmt::format("| undo | {} | | | {:.4f} | {:.2f} |\n\n", undo.size(), milliseconds(undo, false),
                       milliseconds(undo, true));
    out += fmt::format(
        "{} nodes, {:.0f} edits, {:.0f} bytes of history each, {:.1f} MB more memory; after undoing all the "
        "tree is {}\n",
        first.size(), steps, history / std::max(1.0, steps), static_cast<double>(after - before) / 1e6,
        is_same(tree.skeleton(), first) ? "bit-identical to the first one" : "ANOTHER");
    bench::publish({.markdown = out, .json = {}, .csv = {}}, flags.program);
}

}  // namespace

int main(int argc, char** argv) {
    CLI::App app("Measures the costs of edits of trees.");
    bench::EditFlags flags{.segments = 30'000, .edits = 10'000};
    bench::add_edit_flags(app, flags);
    return coppice::bench::run_program(app, argc, argv, [&] { run(flags); });
}
