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

/// State of a point in Dijkstra's algorithm; small, because most of the time is spent on cache misses.
struct PointState {
    double cost;
    float spacing;  ///< [m] limited to the median
    std::uint32_t parent;
};

/// Directions at a point, for costs of turns.
struct Course {
    Vec3 position;
    Vec3 outward;  ///< unit direction of growth; zero if unknown
    Vec3 heading;  ///< direction of the path; zero at its start
};

/// State of Dijkstra's algorithm.
struct PathSearch {
    PathSearch(const Graph& of, std::span<const std::uint32_t> taken_points, const PathCost& rule,
               const Context& ctx)
        : graph(of),
          taken(taken_points),
          grows(!rule.outward.empty()),
          point(of.size()),
          course(rule.position.size()) {
        const float most = median(rule.spacing);
        parallel_for(ctx, graph.size(), kPathsGrain, [&](std::size_t p) {
            const double cost = taken[p] == kNoIndex ? std::numeric_limits<double>::infinity() : kNever;
            point[p] = {cost, std::min(rule.spacing[p], most), kNoIndex};
            if (!course.empty()) course[p] = {rule.position[p], grows ? rule.outward[p] : Vec3{}, Vec3{}};
        });
        distance.assign(graph.size(), std::numeric_limits<float>::infinity());
    }

    /// Finalizes the path to a point with this cost and relaxes its links.
    template <bool kTurns>
    void settle(std::uint32_t p, double at) {
        if (taken[p] == kNoIndex) {
            order.push_back(p);
            distance[p] = static_cast<float>(at);
        }
        const auto spacing = double{point[p].spacing};
        for (std::uint32_t e = graph.first[p]; e < graph.first[p + 1]; ++e) {
            const std::uint32_t q = graph.to[e];
            PointState& to = point[q];
            if (to.cost <= at) continue;  // finalized, or taken
            const double length = double{graph.length[e]}, unit = 0.5 * (spacing + double{to.spacing});
            if (kMinDetour * (length * length) >= (to.cost - at) * (unit * unit)) continue;
            const double share = length / unit;
            Vec3 along;
            if constexpr (kTurns) along = normalized(course[q].position - course[p].position, Vec3{});
            const double next = at + share * share * (kTurns ? compute_detour(p, q, along) : 1);
            if (!(next < to.cost)) continue;
            to.cost = next;
            to.parent = p;
            if constexpr (kTurns) {
                const auto keep = static_cast<float>(std::exp(-share / kHeading));
                course[q].heading = normalized(keep * course[p].heading + (1 - keep) * along, along);
            }
            open.push(next, q);
        }
    }

    /// Returns the cost of a link relative to a link straight on and outward.
    double compute_detour(std::uint32_t p, std::uint32_t q, Vec3 along) const {
        double factor = 1;
        const Vec3 heading = course[p].heading;
        if (length_squared(heading) > 0) factor += kTurn * (1 - double{dot(along, heading)});
        if (!grows) return factor;
        const double off = 1 - double{dot(along, course[q].outward)};
        return factor * (1 + kInward * off * off);
    }

    /// Finalizes all paths from the points marked by `starts`, in the order of their costs.
    template <bool kTurns>
    void run(std::span<const std::uint8_t> starts, const Context& ctx) {
        std::size_t turn = 0;
        for (std::uint32_t p = 0; p < graph.size(); ++p) {
            poll_stop(ctx, turn++);
            if (starts[p]) settle<kTurns>(p, 0);
        }
        while (!open.empty()) {
            poll_stop(ctx, turn++);
            const auto [cost, p] = open.pop();
            if (cost == point[p].cost) settle<kTurns>(p, cost);
        }
    }

    /// Moves the result out of the search.
    Paths take_paths(const Context& ctx) {
        Paths paths{{}, std::move(distance), std::move(order)};
        paths.parent.resize(graph.size());
        parallel_for(ctx, graph.size(), kPathsGrain,
                     [&](std::size_t p) { paths.parent[p] = point[p].parent; });
        return paths;
    }

    static constexpr std::size_t kPathsGrain = 16384;
    static constexpr double kNever = -1;       // cost of taken points: no path is cheaper
    static constexpr double kMinDetour = 0.9;  // lower bound of the relative cost, including rounding

    const Graph& graph;
    std::span<const std::uint32_t> taken;
    bool grows;  // whether directions of growth are known
    Buffer<PointState> point;
    Buffer<Course> course;  // empty if turns have no cost
    RadixHeap open;
    Buffer<float> distance;
    std::vector<std::uint32_t> order;
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
    PathSearch search(graph, taken, rule, ctx);
    std::vector<std::uint8_t> starts(graph.size(), 0);
    for (const std::uint32_t p : sources) {
        starts[p] = 1;
        if (taken[p] == kNoIndex) search.point[p].cost = 0;
    }
    if (2 * sources.size() > graph.size()) drop_enclosed(graph, taken, starts);
    if (rule.position.empty()) {
        search.run<false>(starts, ctx);
    } else {
        search.run<true>(starts, ctx);
    }
    return search.take_paths(ctx);
}

}  // namespace coppice::extract_internal
