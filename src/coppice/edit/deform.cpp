#include "coppice/edit/deform.h"

#include <fmt/format.h>

#include <algorithm>
#include <unordered_map>

#include "coppice/edit/motion_internal.h"
#include "coppice/edit/parts_internal.h"
#include "coppice/edit/selection.h"

namespace coppice {

using namespace edit_internal;

namespace {

/// An axis with its joint as first node. The axis of a root begins with the root.
struct Chain {
    std::vector<StableId> node;
    std::vector<Vec3d> rest;  ///< positions of the nodes before the edit

    std::size_t size() const { return node.size(); }
    Vec3d edge(std::size_t i) const { return rest[i] - rest[i - 1]; }
};

Chain find_chain(const EditableTree& tree, std::vector<StableId> nodes) {
    Chain chain{.node = std::move(nodes), .rest = {}};
    for (const StableId n : chain.node) chain.rest.push_back(get_position(tree, n));
    return chain;
}

Chain chain_from(const EditableTree& tree, StableId top) {
    std::vector<StableId> nodes = axis_from(tree, top);
    if (!tree.is_root(top)) nodes.insert(nodes.begin(), tree.parent(top));
    return find_chain(tree, std::move(nodes));
}

/// Returns the length along the chain up to each node.
std::vector<double> lengths_along(const Chain& chain) {
    std::vector<double> along(chain.size(), 0.0);
    for (std::size_t i = 1; i < chain.size(); ++i) along[i] = along[i - 1] + length(chain.edge(i));
    return along;
}

/// Moves all nodes of a chain except the first to their new positions; branches on them rotate with them.
void carry(TreeEdit& edit, const EditableTree& tree, const Chain& chain, const std::vector<Vec3d>& place,
           const std::vector<Rotation>& turn) {
    for (std::size_t i = 1; i < chain.size(); ++i) {
        const StableId next = i + 1 < chain.size() ? chain.node[i + 1] : StableId::none();
        const Motion motion{.from = Vec3(chain.rest[i]), .to = place[i], .turn = turn[i]};
        for (StableId c = tree.first_child(chain.node[i]); c; c = tree.next_sibling(c)) {
            if (c != next) edit.move_subtree(c, motion);
        }
    }
    for (std::size_t i = 1; i < chain.size(); ++i) {
        edit.move(chain.node[i], Vec3(place[i]));
        edit.turn(chain.node[i], turn[i]);
    }
}

void bend_chain(TreeEdit& edit, const EditableTree& tree, const Chain& chain, double angle, Vec3d towards) {
    if (chain.size() < 3) {
        throw InvalidInput(fmt::format(
            "the axis of node {} has a single segment, which cannot bend; resample or split it first",
            chain.node.back().index()));
    }
    const Vec3d first = normalized(chain.edge(1));
    const Vec3d axis = normalized(cross(first, towards), perpendicular(first));
    const std::vector<double> along = lengths_along(chain);
    const double whole = along[chain.size() - 2];
    // The angle depends on the start of a segment, so that the first segment does not rotate and the last one
    // rotates by the full angle.
    const auto angle_of_segment = [&](std::size_t i) {
        return whole > 0 ? angle * along[i - 1] / whole : 0.0;
    };
    std::vector<Vec3d> place{chain.rest.front()};
    std::vector<Rotation> turn(1);
    for (std::size_t i = 1; i < chain.size(); ++i) {
        const double before = angle_of_segment(i),
                     behind = i + 1 < chain.size() ? angle_of_segment(i + 1) : before;
        place.push_back(place.back() + rotation_about(axis, before)(chain.edge(i)));
        turn.push_back(rotation_about(axis, 0.5 * (before + behind)));
    }
    carry(edit, tree, chain, place, turn);
}

void twist_chain(TreeEdit& edit, const EditableTree& tree, const Chain& chain, double angle) {
    const std::vector<double> along = lengths_along(chain);
    std::vector<Rotation> turn(1);
    for (std::size_t i = 1; i < chain.size(); ++i) {
        const Vec3d in = normalized(chain.edge(i));
        const Vec3d out = i + 1 < chain.size() ? normalized(chain.edge(i + 1)) : in;
        const double share = along.back() > 0 ? along[i] / along.back() : 0;
        turn.push_back(rotation_about(normalized(in + out, in), angle * share));
    }
    carry(edit, tree, chain, chain.rest, turn);
}

/// Displacements of nodes from their original positions.
using Shifts = std::unordered_map<std::uint32_t, Vec3d>;

/// Shifts nodes along their axes; branches on an axis are shifted with their joint.
void apply_shifts(TreeEdit& edit, const EditableTree& tree, const std::vector<StableId>& tops,
                  const Shifts& own) {
    std::unordered_map<std::uint32_t, std::pair<Vec3d, Vec3d>> shift;  // of the axis, and of the node
    for (const StableId top : tops) {
        tree.visit_subtree(top, [&](StableId n) {
            const StableId parent = tree.parent(n);
            Vec3d axis;
            if (const auto above = n == top ? shift.end() : shift.find(parent.index()); above != shift.end())
                axis = tree.leader(parent) == n ? above->second.first : above->second.second;
            const auto found = own.find(n.index());
            const Vec3d whole = found == own.end() ? axis : axis + found->second;
            shift[n.index()] = {axis, whole};
            if (!(whole == Vec3d{})) edit.move(n, Vec3(get_position(tree, n) + whole));
        });
    }
}

/// The handle and the end condition of a chain that follows a moved node.
struct Pull {
    std::size_t handle = 0;
    bool free_end = false;  ///< the last node is free
};

/// Minimizes the sum over edges of |x_i - x_i-1 - goal_i|^2 / length: one tridiagonal system for the movable
/// nodes from `first` to `last`, with a fixed node before them and, unless the end is free, behind them.
void solve_run(const Chain& chain, const std::vector<Vec3d>& goal, std::size_t first, std::size_t last,
               bool free_end, std::vector<Vec3d>& x) {
    if (first > last) return;
    const auto weight = [&](std::size_t i) { return 1 / std::max(length(chain.edge(i)), 1e-30); };
    std::vector<double> upper;
    std::vector<Vec3d> right;
    for (std::size_t i = first; i <= last; ++i) {
        const double a = weight(i), b = i == last && free_end ? 0 : weight(i + 1);
        Vec3d r = goal[i] * a;
        if (b > 0) r -= goal[i + 1] * b;
        if (i == first) r += x[i - 1] * a;
        if (i == last && b > 0) r += x[i + 1] * b;
        const double pivot = a + b - (i > first ? a * upper.back() : 0);
        if (i > first) r += right.back() * a;
        upper.push_back(b / pivot);
        right.push_back(r / pivot);
    }
    for (std::size_t i = last + 1; i-- > first;) {
        x[i] = right[i - first];
        if (i < last) x[i] += x[i + 1] * upper[i - first];
    }
}

/// Computes the rotations of the nodes from their edges. Fixed ends do not rotate.
std::vector<Rotation> compute_turns(const Chain& chain, const Pull& pull, const std::vector<Vec3d>& x) {
    std::vector<Rotation> edge(chain.size());
    for (std::size_t i = 1; i < chain.size(); ++i) edge[i] = rotation_between(chain.edge(i), x[i] - x[i - 1]);
    std::vector<Rotation> turn(chain.size());
    for (std::size_t i = 1; i + 1 < chain.size(); ++i) turn[i] = between(edge[i], edge[i + 1]);
    const bool ends_free = pull.free_end || pull.handle + 1 == chain.size();
    if (chain.size() > 1 && ends_free) turn.back() = edge.back();
    return turn;
}

void pull_chain(TreeEdit& edit, const EditableTree& tree, const Chain& chain, const Pull& pull, Vec3d to) {
    constexpr int kRounds = 60;
    const std::size_t end = chain.size() - 1;
    const Vec3d by = to - chain.rest[pull.handle];
    const std::vector<double> along = lengths_along(chain);
    std::vector<Vec3d> x = chain.rest;
    for (std::size_t i = 1; i <= end; ++i) {
        const bool before = i <= pull.handle;
        const double span = before ? along[pull.handle] : along[end] - along[pull.handle];
        const double way = before ? along[i] : along[end] - along[i];
        x[i] += by * (!before && pull.free_end ? 1.0 : span > 0 ? way / span : 1.0);
    }
    if (!pull.free_end && end > pull.handle) x[end] = chain.rest[end];
    x[pull.handle] = to;
    std::vector<Rotation> turn;
    std::vector<Vec3d> goal(chain.size());
    for (int round = 0; round < kRounds; ++round) {
        turn = compute_turns(chain, pull, x);
        for (std::size_t i = 1; i <= end; ++i)
            goal[i] = (turn[i - 1](chain.edge(i)) + turn[i](chain.edge(i))) * 0.5;
        if (pull.handle > 0) solve_run(chain, goal, 1, pull.handle - 1, false, x);
        if (pull.handle < end)
            solve_run(chain, goal, pull.handle + 1, pull.free_end ? end : end - 1, pull.free_end, x);
    }
    carry(edit, tree, chain, x, compute_turns(chain, pull, x));
    if (pull.handle == 0) edit.move(chain.node[0], Vec3(to));
}

/// Returns the section of an axis within reach of one of its nodes, and the position of the node in it.
std::pair<Chain, Pull> chain_around(const EditableTree& tree, StableId node, double reach) {
    std::vector<StableId> axis = find_axis(tree, node);
    if (!tree.is_root(axis.front())) axis.insert(axis.begin(), tree.parent(axis.front()));
    const Chain whole = find_chain(tree, axis);
    const std::vector<double> along = lengths_along(whole);
    const auto at = static_cast<std::size_t>(std::ranges::find(axis, node) - axis.begin());
    std::size_t first = at, last = at;
    const auto within = [&](std::size_t i) { return reach <= 0 || std::abs(along[i] - along[at]) < reach; };
    while (first > 0 && (within(first) || first == at)) --first;
    while (last + 1 < axis.size() && (within(last) || last == at)) ++last;
    const auto begin = static_cast<std::ptrdiff_t>(first), end = static_cast<std::ptrdiff_t>(last) + 1;
    const Pull pull{.handle = at - first, .free_end = last + 1 == axis.size() && last > at && within(last)};
    return {find_chain(tree, {axis.begin() + begin, axis.begin() + end}), pull};
}

}  // namespace

EditChange bend(EditableTree& tree, const NodeSet& nodes, double angle, Vec3d towards) {
    if (!(length_squared(towards) > 0) || !is_finite(towards))
        throw InvalidInput("towards has no direction; enter three numbers that are not all 0");
    check_set(tree, nodes);
    TreeEdit edit(tree);
    for (const StableId top : find_tops(tree, nodes))
        bend_chain(edit, tree, chain_from(tree, top), angle, towards);
    return edit.commit();
}

EditChange twist(EditableTree& tree, const NodeSet& nodes, double angle) {
    check_set(tree, nodes);
    TreeEdit edit(tree);
    for (const StableId top : find_tops(tree, nodes)) twist_chain(edit, tree, chain_from(tree, top), angle);
    return edit.commit();
}

EditChange straighten(EditableTree& tree, const NodeSet& nodes, double amount) {
    check_set(tree, nodes);
    TreeEdit edit(tree);
    const std::vector<StableId> tops = find_tops(tree, nodes);
    Shifts shifts;
    for (const StableId top : tops) {
        const Chain chain = chain_from(tree, top);
        const std::vector<double> along = lengths_along(chain);
        for (std::size_t i = 1; i + 1 < chain.size(); ++i) {
            const Vec3d straight = lerp(chain.rest.front(), chain.rest.back(), along[i] / along.back());
            shifts[chain.node[i].index()] = (straight - chain.rest[i]) * amount;
        }
    }
    apply_shifts(edit, tree, tops, shifts);
    return edit.commit();
}

EditChange smooth(EditableTree& tree, const NodeSet& nodes, int passes) {
    check_set(tree, nodes);
    TreeEdit edit(tree);
    std::vector<StableId>
        inside;  // excludes tips and first nodes of axes, because their joints belong to other axes
    for (const StableId n : nodes) {
        if (!tree.is_root(n) && !tree.is_tip(n) && tree.leader(tree.parent(n)) == n) inside.push_back(n);
    }
    Shifts shifts;
    const auto compute_shift = [&](StableId n) {
        const auto found = shifts.find(n.index());
        return found == shifts.end() ? Vec3d{} : found->second;
    };
    for (int pass = 0; pass < passes; ++pass) {
        Shifts next;
        for (const StableId n : inside) {
            const StableId before = tree.parent(n), behind = tree.leader(n);
            const Vec3d a = get_position(tree, before) + compute_shift(before),
                        b = get_position(tree, behind) + compute_shift(behind);
            const Vec3d middle = lerp(a, b, 0.5), here = get_position(tree, n);
            next[n.index()] = lerp(here + compute_shift(n), middle, 0.5) - here;
        }
        shifts = std::move(next);
    }
    apply_shifts(edit, tree, find_tops(tree, nodes), shifts);
    return edit.commit();
}

EditChange move_node(EditableTree& tree, StableId node, Vec3d to, double reach) {
    check_node(tree, node);
    const Vec3d local = to - tree.origin();
    if (!is_finite(local))
        throw InvalidInput("the target position is not finite; enter three finite numbers");
    TreeEdit edit(tree);
    const auto [chain, pull] = chain_around(tree, node, reach);
    pull_chain(edit, tree, chain, pull, local);
    return edit.commit();
}

}  // namespace coppice
