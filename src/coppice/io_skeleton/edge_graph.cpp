#include <algorithm>
#include <limits>
#include <numeric>
#include <optional>
#include <span>

#include <fmt/format.h>

#include "coppice/base/error.h"
#include "coppice/base/id.h"
#include "coppice/io_skeleton/parsers_internal.h"

namespace coppice {

namespace {

using Edge = std::array<std::uint32_t, 2>;

void check_finite(const EdgeGraph& graph, const std::string& source) {
    for (std::size_t i = 0; i < graph.position.size(); ++i) {
        if (!is_finite(graph.position[i])) {
            throw InvalidInput(fmt::format("{}: the position of vertex {} is not finite", source, i + 1));
        }
    }
}

/// Returns for each vertex the first one at the same position.
std::vector<std::uint32_t> first_at_position(const std::vector<Vec3d>& position) {
    std::vector<std::uint32_t> order(position.size());
    std::iota(order.begin(), order.end(), 0u);
    std::sort(order.begin(), order.end(), [&](std::uint32_t a, std::uint32_t b) {
        const Vec3d &p = position[a], &q = position[b];
        if (p.x != q.x) return p.x < q.x;
        if (p.y != q.y) return p.y < q.y;
        if (p.z != q.z) return p.z < q.z;
        return a < b;
    });
    std::vector<std::uint32_t> first(position.size());
    for (std::size_t i = 0; i < order.size(); ++i) {
        const bool same = i > 0 && position[order[i]] == position[order[i - 1]];
        first[order[i]] = same ? first[order[i - 1]] : order[i];
    }
    return first;
}

/// The graph with welded vertices, without duplicate edges, and the neighbours of each vertex.
class Adjacency {
  public:
    explicit Adjacency(const EdgeGraph& graph)
        : representative_(graph.position.size()), named_(graph.position.size()) {
        if (graph.weld) {
            representative_ = first_at_position(graph.position);
        } else {
            std::iota(representative_.begin(), representative_.end(), 0u);
        }
        directed_ = graph.directed;
        collect_edges(graph.edges);
        fill_neighbours();
    }

    std::uint32_t size() const { return static_cast<std::uint32_t>(representative_.size()); }
    std::uint32_t representative(std::uint32_t v) const { return representative_[v]; }
    bool is_vertex(std::uint32_t v) const { return representative_[v] == v; }
    bool is_named(std::uint32_t v) const { return named_[v]; }
    bool directed() const { return directed_; }  ///< whether no pair of vertices is joined in both directions
    const std::vector<Edge>& edges() const { return edges_; }

    std::span<const std::uint32_t> neighbours(std::uint32_t v) const {
        return {neighbour_.data() + first_[v], first_[v + 1] - first_[v]};
    }

  private:
    void collect_edges(const std::vector<Edge>& edges) {
        edges_.reserve(edges.size());
        for (const auto& [a, b] : edges) {
            const std::uint32_t from = representative_[a], to = representative_[b];
            named_[from] = named_[to] = true;
            if (from != to) edges_.push_back({from, to});
        }
        const auto key = [](const Edge& e) { return std::pair(std::min(e[0], e[1]), std::max(e[0], e[1])); };
        std::sort(edges_.begin(), edges_.end(), [&](const Edge& a, const Edge& b) {
            return key(a) != key(b) ? key(a) < key(b) : a[0] < b[0];
        });
        const auto last = std::unique(edges_.begin(), edges_.end(), [&](const Edge& a, const Edge& b) {
            if (key(a) != key(b)) return false;
            if (a[0] != b[0]) directed_ = false;
            return true;
        });
        edges_.erase(last, edges_.end());
    }

    void fill_neighbours() {
        first_.assign(size() + 1, 0);
        for (const Edge& e : edges_) {
            ++first_[e[0] + 1];
            ++first_[e[1] + 1];
        }
        std::partial_sum(first_.begin(), first_.end(), first_.begin());
        neighbour_.resize(2 * edges_.size());
        std::vector<std::size_t> next(first_.begin(), first_.end() - 1);
        for (const Edge& e : edges_) {
            neighbour_[next[e[0]]++] = e[1];
            neighbour_[next[e[1]]++] = e[0];
        }
    }

    std::vector<std::uint32_t> representative_;
    std::vector<bool> named_;
    bool directed_ = false;
    std::vector<Edge> edges_;
    std::vector<std::size_t> first_;
    std::vector<std::uint32_t> neighbour_;
};

/// Returns the parents given by directed edges; nullopt if a node has two parents or the edges contain a
/// cycle.
std::optional<std::vector<std::uint32_t>> directed_parents(const Adjacency& graph) {
    if (!graph.directed()) return std::nullopt;
    std::vector<std::uint32_t> parent(graph.size(), kNoIndex);
    for (const auto& [from, to] : graph.edges()) {
        if (parent[to] != kNoIndex) return std::nullopt;
        parent[to] = from;
    }
    // Every node must be a descendant of a root: traverse from the roots and count.
    std::vector<std::uint32_t> reached;
    for (std::uint32_t v = 0; v < graph.size(); ++v) {
        if (parent[v] == kNoIndex) reached.push_back(v);
    }
    for (std::size_t i = 0; i < reached.size(); ++i) {
        for (const std::uint32_t n : graph.neighbours(reached[i])) {
            if (parent[n] == reached[i]) reached.push_back(n);
        }
    }
    if (reached.size() != graph.size()) return std::nullopt;
    return parent;
}

/// Finds parents by breadth-first search from one root in each connected component.
class RootedSearch {
  public:
    RootedSearch(const Adjacency& graph, const std::vector<Vec3d>& position,
                 const std::vector<double>& radius)
        : graph_(graph),
          position_(position),
          radius_(radius),
          seen_(graph.size()),
          parent_(graph.size(), kNoIndex) {}

    std::vector<std::uint32_t> parents() {
        std::vector<std::uint32_t> part;
        for (std::uint32_t v = 0; v < graph_.size(); ++v) {
            if (seen_[v] != 0) continue;
            part.assign(1, v);
            search(part, 1);
            part.assign(1, find_root(part));
            search(part, 2);
        }
        return std::move(parent_);
    }

  private:
    void search(std::vector<std::uint32_t>& queue, char round) {
        seen_[queue[0]] = round;
        for (std::size_t i = 0; i < queue.size(); ++i) {
            for (const std::uint32_t n : graph_.neighbours(queue[i])) {
                if (seen_[n] == round) continue;
                seen_[n] = round;
                if (round == 2) parent_[n] = queue[i];
                queue.push_back(n);
            }
        }
    }

    /// Chooses the root of a component: preferably an end; then the thickest, then the lowest, then the first
    /// vertex.
    std::uint32_t find_root(const std::vector<std::uint32_t>& part) const {
        std::uint32_t best = kNoIndex;
        for (const std::uint32_t v : part) {
            if (best == kNoIndex || is_better(v, best)) best = v;
        }
        return best;
    }

    bool is_better(std::uint32_t v, std::uint32_t best) const {
        const bool end = graph_.neighbours(v).size() <= 1, best_end = graph_.neighbours(best).size() <= 1;
        if (end != best_end) return end;
        if (!radius_.empty() && radius_[v] != radius_[best]) return radius_[v] > radius_[best];
        if (position_[v].z != position_[best].z) return position_[v].z < position_[best].z;
        return v < best;
    }

    const Adjacency& graph_;
    const std::vector<Vec3d>& position_;
    const std::vector<double>& radius_;
    std::vector<char> seen_;
    std::vector<std::uint32_t> parent_;
};

std::vector<double> welded_radii(const EdgeGraph& graph, const Adjacency& adjacency) {
    std::vector<double> radius = graph.radius;
    for (std::uint32_t v = 0; v < radius.size(); ++v) {
        double& welded = radius[adjacency.representative(v)];
        if (!(welded >= graph.radius[v])) welded = graph.radius[v];
    }
    return radius;
}

}  // namespace

Forest make_forest(const EdgeGraph& graph, const std::string& source) {
    check_finite(graph, source);
    const Adjacency adjacency(graph);
    const std::vector<double> radius = welded_radii(graph, adjacency);
    std::optional<std::vector<std::uint32_t>> parent = directed_parents(adjacency);
    if (!parent) parent = RootedSearch(adjacency, graph.position, radius).parents();

    Forest forest;
    std::uint32_t tree_edges = 0;
    for (std::uint32_t v = 0; v < adjacency.size(); ++v) {
        if (!adjacency.is_vertex(v) || (graph.drop_isolated && !adjacency.is_named(v))) continue;
        const std::uint32_t up = (*parent)[v];
        if (up != kNoIndex) ++tree_edges;
        forest.nodes.push_back({v, up == kNoIndex ? -1 : static_cast<std::int64_t>(up), graph.position[v],
                                radius.empty() ? 0.0 : radius[v], v + 1});
    }
    forest.loops_cut = static_cast<std::uint32_t>(adjacency.edges().size()) - tree_edges;
    return forest;
}

}  // namespace coppice
