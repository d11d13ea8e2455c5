#include "coppice/extract/points/graph_internal.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

#include "coppice/base/compressed_rows.h"
#include "coppice/base/disjoint_sets.h"
#include "coppice/base/id.h"
#include "coppice/base/median.h"
#include "coppice/base/parallel.h"
#include "coppice/base/progress.h"
#include "coppice/base/radix_heap.h"

namespace coppice::extract_internal {
namespace {

constexpr double kTurn = 4;     // weight of (1 - cosine) of a turn, added to the relative cost of a link
constexpr double kInward = 8;   // weight of (1 - cosine)^2 against the direction of growth
constexpr double kHeading = 3;  // [spacing] decay length of the direction of a path

/// Calls visit(i, j, length) once for every link.
template <class Visit>
void for_each_link(const Neighbours& neighbours, std::span<const std::uint8_t> ignored,
                   std::span<const Link> more, double longest, const Context& ctx, const Visit& visit) {
    for (std::uint32_t i = 0; i < ignored.size(); ++i) {
        poll_stop(ctx, i);
        if (ignored[i]) continue;
        for (std::uint32_t k = 0; k < neighbours.count; ++k) {
            const std::uint32_t j = neighbours.of(i)[k];
            const float length = neighbours.distances(i)[k];
            if (ignored[j] || double{length} > longest || (j < i && neighbours.lists(j, i))) continue;
            visit(i, j, length);
        }
    }
    for (const Link& link : more) visit(link.from, link.to, link.length);
}

/// Returns the cost of a link relative to a link straight on and outward.
double detour(const PathCost& rule, std::span<const Vec3> heading, std::uint32_t p, std::uint32_t q,
              Vec3 along) {
    double factor = 1;
    if (heading.empty()) return factor;
    if (length_squared(heading[p]) > 0) factor += kTurn * (1 - double{dot(along, heading[p])});
    if (rule.outward.empty()) return factor;
    const double off = 1 - double{dot(along, rule.outward[q])};
    return factor * (1 + kInward * off * off);
}

/// Converts the sets to components, sorted by their first members.
Components numbered_sets(DisjointSets& sets, std::size_t count) {
    Components parts;
    parts.of.resize(count);
    for (std::uint32_t i = 0; i < count; ++i) {
        const std::uint32_t first = sets.find(i);
        if (first == i) {
            parts.of[i] = static_cast<std::uint32_t>(parts.size.size());
            parts.size.push_back(0);
        }
        parts.of[i] = parts.of[first];
        ++parts.size[parts.of[i]];
    }
    return parts;
}

/// State of Dijkstra's algorithm.
struct PathSearch {
    PathSearch(const Graph& of, std::span<const std::uint32_t> taken_points, const PathCost& cost_rule)
        : graph(of),
          taken(taken_points),
          rule(cost_rule),
          cost(of.size(), std::numeric_limits<double>::infinity()),
          spacing(rule.spacing.begin(), rule.spacing.end()),
          heading(rule.position.size(), Vec3{}) {
        const float most = median(rule.spacing);
        for (float& s : spacing) s = std::min(s, most);
        for (std::uint32_t p = 0; p < graph.size(); ++p)
            if (taken[p] != kNoIndex) cost[p] = kNever;
        paths.parent.assign(graph.size(), kNoIndex);
        paths.distance.assign(graph.size(), std::numeric_limits<float>::infinity());
    }

    /// Finalizes the path to a point with this cost and relaxes its links.
    void settle(std::uint32_t p, double at) {
        if (taken[p] == kNoIndex) {
            paths.order.push_back(p);
            paths.distance[p] = static_cast<float>(at);
        }
        for (std::uint32_t e = graph.first[p]; e < graph.first[p + 1]; ++e) {
            const std::uint32_t q = graph.to[e];
            if (cost[q] <= at) continue;  // finalized, or taken
            const double share = double{graph.length[e]} / (0.5 * (double{spacing[p]} + double{spacing[q]}));
            if (at + kMinDetour * (share * share) >= cost[q]) continue;
            Vec3 along;
            if (!heading.empty()) along = normalized(rule.position[q] - rule.position[p], Vec3{});
            const double next = at + share * share * detour(rule, heading, p, q, along);
            if (!(next < cost[q])) continue;
            cost[q] = next;
            paths.parent[q] = p;
            if (!heading.empty()) {
                const auto keep = static_cast<float>(std::exp(-share / kHeading));
                heading[q] = normalized(keep * heading[p] + (1 - keep) * along, along);
            }
            open.push(next, q);
        }
    }

    static constexpr double kNever = -1;       // cost of taken points: no path is cheaper
    static constexpr double kMinDetour = 0.9;  // lower bound of the relative cost, including rounding

    const Graph& graph;
    std::span<const std::uint32_t> taken;
    const PathCost& rule;
    Buffer<double> cost;
    Buffer<float> spacing;  // [m] limited to the median
    Buffer<Vec3> heading;   // direction of the path at each point; empty if turns have no cost
    RadixHeap open;
    Paths paths;
};

/// Unmarks taken sources with only taken neighbours: no path leaves them.
void drop_enclosed(const Graph& graph, std::span<const std::uint32_t> taken,
                   std::vector<std::uint8_t>& starts) {
    std::vector<std::uint8_t> enclosed(graph.size(), 1);
    for (std::uint32_t p = 0; p < graph.size(); ++p) {
        if (taken[p] != kNoIndex) continue;
        enclosed[p] = 0;
        for (std::uint32_t e = graph.first[p]; e < graph.first[p + 1]; ++e) enclosed[graph.to[e]] = 0;
    }
    for (std::uint32_t p = 0; p < graph.size(); ++p)
        if (enclosed[p]) starts[p] = 0;
}

}  // namespace

Graph make_graph(const Neighbours& neighbours, std::span<const std::uint8_t> ignored,
                 std::span<const Link> more, const Context& ctx, double longest) {
    Graph graph;
    graph.first.assign(ignored.size() + 1, 0);
    for_each_link(neighbours, ignored, more, longest, ctx, [&](std::uint32_t i, std::uint32_t j, float) {
        ++graph.first[i];
        ++graph.first[j];
    });
    const std::uint32_t total = exclusive_scan(std::span(graph.first));
    graph.to.resize(total);
    graph.length.resize(total);
    std::vector<std::uint32_t> next(graph.first.begin(), graph.first.end());
    for_each_link(neighbours, ignored, more, longest, ctx,
                  [&](std::uint32_t i, std::uint32_t j, float length) {
                      graph.to[next[i]] = j;
                      graph.length[next[i]++] = length;
                      graph.to[next[j]] = i;
                      graph.length[next[j]++] = length;
                  });
    return graph;
}

Components components(const Graph& graph, const Context& ctx) {
    DisjointSets sets(graph.size());
    for (std::uint32_t p = 0; p < graph.size(); ++p) {
        poll_stop(ctx, p);
        for (std::uint32_t e = graph.first[p]; e < graph.first[p + 1]; ++e)
            if (graph.to[e] < p) sets.join(p, graph.to[e]);
    }
    return numbered_sets(sets, graph.size());
}

Components components(const Neighbours& neighbours, std::span<const std::uint8_t> ignored,
                      std::span<const Link> more, const Context& ctx, double longest) {
    DisjointSets sets(ignored.size());
    for (std::uint32_t i = 0; i < ignored.size(); ++i) {
        poll_stop(ctx, i);
        for (std::uint32_t k = 0; !ignored[i] && k < neighbours.count; ++k) {
            const std::uint32_t j = neighbours.of(i)[k];
            if (!ignored[j] && double{neighbours.distances(i)[k]} <= longest) sets.join(i, j);
        }
    }
    for (const Link& link : more) sets.join(link.from, link.to);
    return numbered_sets(sets, ignored.size());
}

Paths shortest_paths(const Graph& graph, std::span<const std::uint32_t> sources,
                     std::span<const std::uint32_t> taken, const PathCost& rule, const Context& ctx) {
    PathSearch search(graph, taken, rule);
    std::vector<std::uint8_t> starts(graph.size(), 0);
    for (const std::uint32_t p : sources) {
        starts[p] = 1;
        if (taken[p] == kNoIndex) search.cost[p] = 0;
    }
    if (2 * sources.size() > graph.size()) drop_enclosed(graph, taken, starts);
    std::size_t turn = 0;
    for (std::uint32_t p = 0; p < graph.size(); ++p) {
        poll_stop(ctx, turn++);
        if (starts[p]) search.settle(p, 0);
    }
    while (!search.open.empty()) {
        poll_stop(ctx, turn++);
        const auto [cost, p] = search.open.pop();
        if (cost == search.cost[p]) search.settle(p, cost);
    }
    return std::move(search.paths);
}

}  // namespace coppice::extract_internal
