#include "coppice/edit/thickness.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <unordered_map>
#include <unordered_set>

#include "coppice/edit/parts_internal.h"
#include "coppice/edit/selection.h"

namespace coppice {

using namespace edit_internal;

namespace {

void check_positive(double value, const char* subject) {
    if (!(value > 0) || !std::isfinite(value))
        throw InvalidInput(
            fmt::format("the {} {} is not above 0; enter a finite number above 0", subject, value));
}

void check_radius_or_zero(double value) {
    if (!(value >= 0) || !std::isfinite(value))
        throw InvalidInput(
            fmt::format("the radius {} is not above 0; enter 0 to keep the existing one", value));
}

/// Returns whether a node would still be the leader with this radius, if its siblings keep theirs.
bool still_leads(const EditableTree& tree, StableId n, float radius) {
    for (StableId s = tree.first_child(tree.parent(n)); s; s = tree.next_sibling(s)) {
        if (s != n && (tree.radius(s) > radius || (tree.radius(s) == radius && s < n))) return false;
    }
    return true;
}

}  // namespace

EditChange set_radii(EditableTree& tree, const NodeSet& nodes, double radius) {
    check_positive(radius, "radius");
    check_set(tree, nodes);
    TreeEdit edit(tree);
    for (const StableId n : nodes) edit.set_radius(n, static_cast<float>(radius));
    return edit.commit();
}

EditChange scale_radii(EditableTree& tree, const NodeSet& nodes, double factor) {
    check_positive(factor, "factor");
    check_set(tree, nodes);
    TreeEdit edit(tree);
    for (const StableId n : nodes) edit.set_radius(n, static_cast<float>(tree.radius(n) * factor));
    return edit.commit();
}

EditChange taper(EditableTree& tree, const NodeSet& nodes, double from, double to) {
    check_radius_or_zero(from);
    check_radius_or_zero(to);
    check_set(tree, nodes);
    TreeEdit edit(tree);
    for (const StableId top : find_tops(tree, nodes)) {
        const std::vector<StableId> axis = axis_from(tree, top);
        std::vector<double> along{0};
        for (std::size_t i = 1; i < axis.size(); ++i)
            along.push_back(along.back() +
                            distance(get_position(tree, axis[i]), get_position(tree, axis[i - 1])));
        const double first = from > 0 ? from : double{tree.radius(axis.front())};
        const double last = to > 0 ? to : double{tree.radius(axis.back())};
        for (std::size_t i = 0; i < axis.size(); ++i) {
            const double t = along.back() > 0 ? along[i] / along.back() : 0;
            edit.set_radius(axis[i], static_cast<float>(first + (last - first) * t));
        }
    }
    return edit.commit();
}

EditChange smooth_radii(EditableTree& tree, const NodeSet& nodes, int passes) {
    check_set(tree, nodes);
    std::vector<StableId> inside;
    for (const StableId n : nodes) {
        if (!tree.is_root(n) && !tree.is_tip(n) && tree.leader(tree.parent(n)) == n) inside.push_back(n);
    }
    TreeEdit edit(tree);
    for (int pass = 0; pass < passes; ++pass) {
        std::vector<float> smoothed;
        for (const StableId n : inside) {
            const float around = tree.radius(tree.parent(n)) + tree.radius(tree.leader(n));
            smoothed.push_back(0.5f * tree.radius(n) + 0.25f * around);
        }
        for (std::size_t i = 0; i < inside.size(); ++i) {
            if (still_leads(tree, inside[i], smoothed[i])) edit.set_radius(inside[i], smoothed[i]);
        }
    }
    return edit.commit();
}

EditChange pipe_radii(EditableTree& tree, const NodeSet& nodes, double exponent) {
    check_positive(exponent, "exponent");
    check_set(tree, nodes);
    // Number of children that remain to be processed for every node on a path, so that each node comes after
    // them.
    std::unordered_map<std::uint32_t, int> waiting;
    std::unordered_set<std::uint32_t> counted;
    for (const StableId start : nodes) {
        for (StableId n = start; !tree.is_root(n) && counted.insert(n.index()).second; n = tree.parent(n))
            ++waiting[tree.parent(n).index()];
    }
    std::vector<StableId> ready;
    for (const StableId n : nodes) {
        if (!waiting.contains(n.index())) ready.push_back(n);
    }
    TreeEdit edit(tree);
    while (!ready.empty()) {
        const StableId n = ready.back();
        ready.pop_back();
        if (waiting.contains(n.index())) {
            double sum = 0;
            for (StableId c = tree.first_child(n); c; c = tree.next_sibling(c))
                sum += std::pow(double{tree.radius(c)}, exponent);
            edit.set_radius(n, static_cast<float>(std::pow(sum, 1 / exponent)));
        }
        if (!tree.is_root(n) && --waiting.at(tree.parent(n).index()) == 0) ready.push_back(tree.parent(n));
    }
    return edit.commit();
}

}  // namespace coppice
