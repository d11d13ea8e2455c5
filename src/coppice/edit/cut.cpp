#include "coppice/edit/cut.h"

#include <fmt/format.h>

#include <algorithm>
#include <iterator>

#include "coppice/base/option_fields.h"
#include "coppice/edit/parts_internal.h"

namespace coppice {

using namespace edit_internal;

namespace {

constexpr int kMaxParts = 1000;
constexpr double kMaxNodes = 1e7;  // maximum number of nodes created by resampling an axis

NodeSet without_roots(const EditableTree& tree, const NodeSet& nodes) {
    check_set(tree, nodes);
    NodeSet out;
    std::ranges::copy_if(nodes, std::back_inserter(out), [&](StableId n) { return !tree.is_root(n); });
    if (out.empty())
        throw InvalidInput("only roots are selected, and no segment ends at them; select other nodes");
    return out;
}

/// Returns whether resampling may remove a node: it is selected and has a parent and a single child.
bool is_loose(const EditableTree& tree, const NodeSet& nodes, StableId n) {
    return !tree.is_root(n) && !tree.is_tip(n) && !tree.next_sibling(tree.first_child(n)) && holds(nodes, n);
}

/// Returns the nodes at which runs of removable nodes end.
std::vector<StableId> ends_of_runs(const EditableTree& tree, const NodeSet& nodes) {
    std::vector<StableId> ends;
    for (const StableId n : nodes) {
        if (!is_loose(tree, nodes, n)) {
            if (!tree.is_root(n)) ends.push_back(n);
        } else if (const StableId next = tree.first_child(n); !holds(nodes, next)) {
            ends.push_back(next);
        }
    }
    return ends;
}

struct Ball {
    Vec3d place;
    double radius;
};

/// Returns evenly spaced points along the segments of a run, without its ends.
std::vector<Ball> evenly(const EditableTree& tree, const std::vector<StableId>& run, double spacing) {
    std::vector<double> along{0};
    for (const StableId n : run)
        along.push_back(along.back() + length(get_position(tree, n) - get_position(tree, tree.parent(n))));
    const double pieces = std::max(1.0, std::round(along.back() / spacing));
    if (pieces > kMaxNodes) {
        throw InvalidInput(fmt::format(
            "a spacing of {} m would make {:.0f} nodes of one axis; use a larger spacing", spacing, pieces));
    }
    std::vector<Ball> out;
    std::size_t at = 0;
    for (double i = 1; i < pieces; ++i) {
        const double want = along.back() * i / pieces;
        while (at + 1 < run.size() && along[at + 1] < want) ++at;
        const Segment s = tree.segment(run[at]);
        const double span = along[at + 1] - along[at], t = span > 0 ? (want - along[at]) / span : 0;
        out.push_back({lerp(Vec3d(s.a), Vec3d(s.b), t), s.radius_a + (double{s.radius_b} - s.radius_a) * t});
    }
    return out;
}

void resample_run(TreeEdit& edit, const EditableTree& tree, const NodeSet& nodes, StableId end,
                  double spacing) {
    std::vector<StableId> run{end};
    while (is_loose(tree, nodes, tree.parent(run.back()))) run.push_back(tree.parent(run.back()));
    std::ranges::reverse(run);
    const std::vector<Ball> balls = evenly(tree, run, spacing);
    const std::size_t kept = std::min(balls.size(), run.size() - 1);
    StableId last = tree.parent(run.front());
    for (std::size_t i = 0; i < balls.size(); ++i) {
        const auto radius = static_cast<float>(balls[i].radius);
        if (i < kept) {
            last = run[i];
            edit.move(last, Vec3(balls[i].place));
            edit.set_radius(last, radius);
        } else {
            last = edit.add(last, Vec3(balls[i].place), radius);
        }
    }
    if (tree.parent(end) == last) return;
    edit.set_parent(end, last);
    if (kept + 1 < run.size()) edit.remove_subtree(run[kept]);
}

}  // namespace

EditChange split(EditableTree& tree, const NodeSet& nodes, int parts) {
    if (parts < 2 || parts > kMaxParts)
        throw InvalidInput(fmt::format("a segment is split in 2 to {} parts, not {}", kMaxParts, parts));
    TreeEdit edit(tree);
    for (const StableId n : without_roots(tree, nodes)) {
        for (int left = parts; left > 1; --left) split_segment(edit, tree, n, 1.0 / left);
    }
    return edit.commit();
}

EditChange split_at(EditableTree& tree, const NodeSet& nodes, double at) {
    if (!(at > 0 && at < 1))
        throw InvalidInput(fmt::format("a segment is split between 0 and 1, its ends, not at {}", at));
    TreeEdit edit(tree);
    for (const StableId n : without_roots(tree, nodes)) split_segment(edit, tree, n, at);
    return edit.commit();
}

EditChange detach(EditableTree& tree, const NodeSet& nodes) {
    TreeEdit edit(tree);
    for (const StableId top : find_tops(tree, without_roots(tree, nodes))) {
        const Segment s = tree.segment(top);
        edit.set_parent(top, edit.add(StableId::none(), s.a, s.radius_a));
    }
    return edit.commit();
}

EditChange remove_branches(EditableTree& tree, const NodeSet& nodes) {
    check_set(tree, nodes);
    TreeEdit edit(tree);
    for (const StableId top : find_tops(tree, nodes)) edit.remove_subtree(top);
    return edit.commit();
}

EditChange dissolve(EditableTree& tree, const NodeSet& nodes) {
    check_set(tree, nodes);
    TreeEdit edit(tree);
    for (const StableId n : nodes) {
        const StableId parent = tree.parent(n);
        while (!tree.is_tip(n)) edit.set_parent(tree.first_child(n), parent);
        edit.remove(n);
    }
    return edit.commit();
}

EditChange resample(EditableTree& tree, const NodeSet& nodes, double spacing) {
    if (!(spacing > 0) || !std::isfinite(spacing))
        throw InvalidInput(
            fmt::format("the spacing {} is not above 0; enter the length of a segment in metres", spacing));
    check_set(tree, nodes);
    TreeEdit edit(tree);
    for (const StableId end : ends_of_runs(tree, nodes)) resample_run(edit, tree, nodes, end, spacing);
    return edit.commit();
}

void list_fields(PruneOptions& o, FieldList& list) {
    list.add(
        Field{"radius", "Minimum radius of axes, which are cut where they are thinner; 0 disables the cut.",
              Unit::metre, 0, 1e6},
        o.radius);
    list.add(
        Field{"length",
              "Minimum length of the longest path from the base of a branch to a tip; shorter branches are "
              "removed; 0 disables the criterion.",
              Unit::metre, 0, 1e6},
        o.length);
    list.add(
        Field{"order",
              "Maximum order of branches; branches of higher order are removed; -1 disables the criterion.",
              Unit::none, -1, 1e6},
        o.order);
    list.add(
        Field{"shade",
              "Maximum shade; branches with more shade at every tip are removed; five tips directly above "
              "make 1; 0 disables the criterion.",
              Unit::none, 0, 1e6},
        o.shade);
    list.add(
        Field{"shade_share",
              "Fraction of the most shaded tips; branches with only such tips are removed; 0 disables the "
              "criterion.",
              Unit::none, 0, 1},
        o.shade_share);
    list.add(
        Field{"shade_cell",
              "Edge length of the grid cells in which shade is computed; 0 uses 1/50 of the extent of the "
              "tree.",
              Unit::metre, 0, 1e6},
        o.shade_cell);
}

}  // namespace coppice
