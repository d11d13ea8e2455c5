#include <algorithm>
#include <array>
#include <cmath>

#include "coppice/base/disjoint_sets.h"
#include "coppice/base/id.h"
#include "coppice/sketch/trace/silhouette_internal.h"

namespace coppice::sketch_internal {
namespace {

// [radius at the fork] minimum length of a line; shorter ones are bumps of the outline
constexpr double kSpur = 1.6;
constexpr double kJoined = 2.5;  // [radius] distance within which two places are merged

struct Pixel {
    int x, y;
};

class Builder {
  public:
    Builder(const Mask& lines, const std::vector<float>& distance)
        : lines_(lines),
          distance_(distance),
          place_(lines.inside.size(), kNoIndex),
          used_(lines.inside.size(), 0) {}

    LineGraph run() {
        find_places();
        for (std::uint32_t p = 0; p < members_.size(); ++p)
            for (const Pixel pixel : members_[p]) follow_all(p, pixel);
        return std::move(graph_);
    }

  private:
    std::vector<Pixel> neighbours(Pixel p) const {
        std::vector<Pixel> out;
        for (int dy = -1; dy <= 1; ++dy)
            for (int dx = -1; dx <= 1; ++dx)
                if ((dx != 0 || dy != 0) && lines_.at(p.x + dx, p.y + dy))
                    out.push_back({p.x + dx, p.y + dy});
        return out;
    }
    std::size_t index(Pixel p) const { return lines_.index(p.x, p.y); }

    /// Finds the pixels that do not have exactly two neighbours and groups adjacent ones.
    void find_places() {
        std::vector<Pixel> stack;
        const auto is_place = [&](Pixel p) { return neighbours(p).size() != 2; };
        for (int y = 0; y < lines_.height; ++y) {
            for (int x = 0; x < lines_.width; ++x) {
                if (!lines_.at(x, y) || place_[lines_.index(x, y)] != kNoIndex || !is_place({x, y})) continue;
                const auto id = static_cast<std::uint32_t>(members_.size());
                members_.emplace_back();
                place_[lines_.index(x, y)] = id;
                stack.push_back({x, y});
                while (!stack.empty()) {
                    const Pixel p = stack.back();
                    stack.pop_back();
                    members_[id].push_back(p);
                    for (const Pixel n : neighbours(p)) {
                        if (place_[index(n)] != kNoIndex || !is_place(n)) continue;
                        place_[index(n)] = id;
                        stack.push_back(n);
                    }
                }
                add_place(id);
            }
        }
    }

    void add_place(std::uint32_t id) {
        MeetingPlace place;
        for (const Pixel p : members_[id]) {
            place.place = place.place + PicturePoint{p.x + 0.5, p.y + 0.5} *
                                            (1.0 / static_cast<double>(members_[id].size()));
            place.radius = std::max(place.radius, double{distance_[index(p)]});
        }
        graph_.places.push_back(std::move(place));
    }

    void follow_all(std::uint32_t from, Pixel start) {
        for (const Pixel first : neighbours(start)) {
            if (place_[index(first)] != kNoIndex || used_[index(first)] != 0) continue;
            Edge edge;
            edge.points = {graph_.places[from].place};
            Pixel before = start, at = first;
            std::uint32_t to = kNoIndex;
            while (to == kNoIndex) {
                used_[index(at)] = 1;
                edge.points.push_back({at.x + 0.5, at.y + 0.5});
                Pixel next = before;
                for (const Pixel n : neighbours(at))
                    if (n.x != before.x || n.y != before.y) next = n;
                if (next.x == before.x && next.y == before.y) break;
                before = at;
                at = next;
                to = place_[index(at)];
            }
            if (to == kNoIndex) continue;
            edge.points.push_back(graph_.places[to].place);
            edge.nodes = {from, to};
            graph_.edges.push_back(std::move(edge));
        }
    }

    const Mask& lines_;
    const std::vector<float>& distance_;
    std::vector<std::uint32_t> place_;  ///< by pixel
    std::vector<std::uint8_t> used_;
    std::vector<std::vector<Pixel>> members_;
    LineGraph graph_;
};

double compute_length(const Edge& edge) {
    double sum = 0;
    for (std::size_t i = 1; i < edge.points.size(); ++i) sum += length(edge.points[i] - edge.points[i - 1]);
    return sum;
}

std::vector<std::uint32_t> degrees(const LineGraph& graph) {
    std::vector<std::uint32_t> out(graph.places.size(), 0);
    for (const Edge& edge : graph.edges)
        for (const std::uint32_t node : edge.nodes) ++out[node];
    return out;
}

void take_spurs(LineGraph& graph) {
    const std::vector<std::uint32_t> degree = degrees(graph);
    std::erase_if(graph.edges, [&](const Edge& edge) {
        for (const std::size_t end : {std::size_t{0}, std::size_t{1}}) {
            if (degree[edge.nodes[end]] != 1 || degree[edge.nodes[1 - end]] < 3) continue;
            if (compute_length(edge) < kSpur * graph.places[edge.nodes[1 - end]].radius) return true;
        }
        return false;
    });
}

/// Merges places within each other's width, and removes the edges between them.
void join_places(LineGraph& graph) {
    const std::vector<std::uint32_t> degree = degrees(graph);
    DisjointSets sets(graph.places.size());
    for (const Edge& edge : graph.edges) {
        const auto [a, b] = edge.nodes;
        if (a == b || degree[a] < 3 || degree[b] < 3) continue;
        if (compute_length(edge) < kJoined * std::max(graph.places[a].radius, graph.places[b].radius))
            sets.join(a, b);
    }
    std::erase_if(graph.edges, [&](const Edge& e) {
        return sets.find(e.nodes[0]) == sets.find(e.nodes[1]) &&
               compute_length(e) < 2 * kJoined * graph.places[e.nodes[0]].radius;
    });
    for (Edge& edge : graph.edges)
        for (std::uint32_t& node : edge.nodes) node = sets.find(node);
}

/// Merges the two remaining edges of a place.
void join_edges(LineGraph& graph) {
    for (MeetingPlace& place : graph.places) place.edges.clear();
    for (std::uint32_t e = 0; e < graph.edges.size(); ++e)
        for (const std::uint32_t node : graph.edges[e].nodes) graph.places[node].edges.push_back(e);
    for (std::uint32_t node = 0; node < graph.places.size(); ++node) {
        std::vector<std::uint32_t>& meeting = graph.places[node].edges;
        if (meeting.size() != 2 || meeting[0] == meeting[1]) continue;
        const auto [a, b] = std::array{meeting[0], meeting[1]};
        Edge& first = graph.edges[a];
        Edge second = std::move(graph.edges[b]);
        if (first.nodes[1] != node) std::ranges::reverse(first.points), std::ranges::reverse(first.nodes);
        if (second.nodes[0] != node) std::ranges::reverse(second.points), std::ranges::reverse(second.nodes);
        first.points.insert(first.points.end(), second.points.begin() + 1, second.points.end());
        first.nodes[1] = second.nodes[1];
        std::ranges::replace(graph.places[second.nodes[1]].edges, b, a);
        graph.edges[b] = {};
        meeting.clear();
    }
}

}  // namespace

LineGraph build_graph(const Mask& lines, const std::vector<float>& distance) {
    LineGraph graph = Builder(lines, distance).run();
    for (int round = 0; round < 3; ++round) take_spurs(graph);
    join_places(graph);
    join_edges(graph);
    return graph;
}

}  // namespace coppice::sketch_internal
