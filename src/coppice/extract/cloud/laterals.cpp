#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>

#include "coppice/base/id.h"
#include "coppice/base/kernel/round_cone.h"
#include "coppice/extract/cloud/initial_tree_internal.h"
#include "coppice/extract/tree/tree_edit_internal.h"

namespace coppice::extract_internal {
namespace {

constexpr double kBend = 2;  // weight of the detour of a bend, relative to the length
// [radius of the parent] maximum distance of the start of a lateral from its fork
constexpr double kReach = 3;
constexpr double kDirection = 5;  // [radius] length over which the direction of a lateral is measured
constexpr int kPlaces = 8;        // number of possible starts on a segment

/// Position on the segment that ends at `node`.
struct Place {
    std::uint32_t node = kNoIndex;
    double t = 1;  ///< from 0 at the parent to 1 at the node
    Vec3d at;
    double radius = 0;
    double cost = std::numeric_limits<double>::infinity();
};

struct Move {
    std::uint32_t lateral;
    Place to;
};

/// State of the move of laterals: the tree with its axes, and the nodes to remove.
struct Laterals {
    InitialTree& tree;
    std::vector<std::uint32_t> next;  ///< per node, the next one on its axis
    InitialTreeLinks links;
    std::vector<char> gone;
    std::vector<std::uint32_t> stands_for;  ///< per node: itself, or the next one tipward if it is removed
};

/// Visits the segments of the axis through a fork on which a lateral from p may start.
template <class Visit>
void visit_parent_branch(const Laterals& l, std::uint32_t fork, Vec3d p, const Visit& visit) {
    const InitialTree& tree = l.tree;
    const double reach = kReach * tree.radius[fork] + distance(p, tree.position[fork]);
    double way = 0;
    for (std::uint32_t q = fork; tree.parent[q] != kNoIndex && way < reach; q = tree.parent[q]) {
        visit(q);
        way += distance(tree.position[q], tree.position[tree.parent[q]]);
    }
    way = 0;
    for (std::uint32_t q = l.next[fork]; q != kNoIndex && way < reach; q = l.next[q]) {
        visit(q);
        way += distance(tree.position[q], tree.position[tree.parent[q]]);
    }
}

/// Returns the first node of a lateral outside its parent branch; marks the previous ones as removed.
std::uint32_t outer_node(Laterals& l, std::uint32_t lateral, std::uint32_t fork) {
    std::uint32_t n = lateral;
    for (; l.next[n] != kNoIndex && l.links.children(n).size() == 1; n = l.next[n]) {
        const Vec3d p = l.tree.position[n];
        bool inside = false;
        visit_parent_branch(l, fork, p, [&](std::uint32_t q) {
            inside = inside || axis_cone(l.tree, q).closest_point(p).signed_distance() <= 0;
        });
        if (!inside) break;
        l.gone[n] = 1;
        l.stands_for[n] = l.next[n];
    }
    return n;
}

/// Returns the node from which the axis of a lateral is extrapolated: `outer`, or, if the lateral ends there,
/// the node before, because a single node has no direction.
std::uint32_t find_start(const Laterals& l, std::uint32_t outer) {
    return l.next[outer] == kNoIndex ? l.tree.parent[outer] : outer;
}

/// Returns the direction of a lateral over some radii from `start`.
Vec3d compute_direction(const Laterals& l, std::uint32_t start, std::uint32_t outer) {
    const InitialTree& tree = l.tree;
    std::uint32_t m = outer;
    while (l.next[m] != kNoIndex &&
           distance(tree.position[m], tree.position[start]) < kDirection * tree.radius[outer])
        m = l.next[m];
    return normalized(tree.position[m] - tree.position[start], {});
}

/// Returns the start from which the connection to a lateral is short and continues its direction.
Place best_place(const Laterals& l, std::uint32_t outer, std::uint32_t fork) {
    const std::uint32_t node = find_start(l, outer);
    const Vec3d start = l.tree.position[node], direction = compute_direction(l, node, outer);
    Place best;
    visit_parent_branch(l, fork, start, [&](std::uint32_t q) {
        const std::uint32_t parent = l.tree.parent[q];
        if (l.gone[q] || l.gone[parent]) return;
        const RoundCone cone = axis_cone(l.tree, q);
        // The first segment of another lateral will be moved: only its end is possible.
        for (int k = l.next[parent] == q ? 0 : kPlaces; k <= kPlaces; ++k) {
            const double t = static_cast<double>(k) / kPlaces;
            const Vec3d at = cone.point(t), way = start - at;
            const double length_of_way = length(way);
            const double cost = length_of_way + kBend * (length_of_way - dot(way, direction));
            if (cost < best.cost) best = {q, t, at, cone.radius(t), cost};
        }
    });
    return best;
}

/// Attaches the laterals at their new starts. The new nodes of several laterals on one segment are connected
/// in order.
void carry_out(InitialTree& tree, std::vector<Move>& moves) {
    std::ranges::stable_sort(moves, [](const Move& a, const Move& b) {
        return a.to.node != b.to.node ? a.to.node < b.to.node : a.to.t < b.to.t;
    });
    for (std::size_t i = 0; i < moves.size();) {
        const std::uint32_t node = moves[i].to.node;
        std::uint32_t parent = tree.parent[node];
        double last = 0;
        for (; i < moves.size() && moves[i].to.node == node; ++i) {
            const Place& to = moves[i].to;
            if (to.t > last && to.t < 1) {
                parent = tree.add(parent, to.at, to.radius, tree.fixed[node] && tree.fixed[parent]);
                last = to.t;
            }
            tree.parent[moves[i].lateral] = to.t == 1 ? node : parent;
        }
        tree.parent[node] = parent;
    }
}

}  // namespace

void reattach_laterals(InitialTree& tree, FitSamples& samples, const Context& ctx) {
    const std::uint32_t size = tree.size();
    Laterals l{tree, axis_children(tree), InitialTreeLinks(tree), std::vector<char>(size, 0),
               std::vector<std::uint32_t>(size)};
    std::iota(l.stands_for.begin(), l.stands_for.end(), 0u);
    std::vector<Move> moves;
    for (std::uint32_t n = 0; n < size; ++n) {
        const std::uint32_t fork = tree.parent[n];
        if (fork == kNoIndex || l.next[fork] == n) continue;
        ctx.throw_if_cancelled();
        const std::uint32_t outer = outer_node(l, n, fork);
        const Place place = best_place(l, outer, fork);
        if (place.node != kNoIndex) {
            moves.push_back({outer, place});
        } else {
            tree.parent[outer] = fork;
        }
    }
    carry_out(tree, moves);
    l.gone.resize(tree.size(), 0);
    const auto new_of_old = sort_parents_first(tree, l.gone);
    for (std::uint32_t& n : samples.node) {
        if (n == kNoIndex) continue;
        while (l.stands_for[n] != n) n = l.stands_for[n];
        n = new_of_old[n];
    }
}

}  // namespace coppice::extract_internal
