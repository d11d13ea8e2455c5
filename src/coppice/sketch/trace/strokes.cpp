#include <algorithm>
#include <cmath>
#include <queue>
#include <tuple>

#include "coppice/base/id.h"
#include "coppice/sketch/trace/silhouette_internal.h"

namespace coppice::sketch_internal {
namespace {

constexpr double kTurnCost = 0.5;    // [diagonal of the image] cost of a right-angle turn
constexpr double kThickCost = 0.5;   // the same for doubling the thickness
constexpr float kStemWidth = 0.25f;  // [maximum width] minimum width of a stem
constexpr double kSpacing = 8;       // [pixels] distance between points of a stroke
constexpr int kSmooth = 6;           // number of points on each side over which a point is averaged

double compute_length(const std::vector<PicturePoint>& points) {
    double sum = 0;
    for (std::size_t i = 1; i < points.size(); ++i) sum += length(points[i] - points[i - 1]);
    return sum;
}

/// Returns the radius [pixels] of the mask at a point.
double radius_at(PicturePoint p, const Mask& mask, const std::vector<float>& distance) {
    const int x = std::clamp(static_cast<int>(p.x), 0, mask.width - 1);
    const int y = std::clamp(static_cast<int>(p.y), 0, mask.height - 1);
    return std::max(double{distance[mask.index(x, y)]} - 0.5, 0.5);
}

class Walker {
  public:
    Walker(const LineGraph& graph, const Mask& mask, const std::vector<float>& distance)
        : graph_(graph),
          mask_(mask),
          distance_(distance),
          before_(graph.edges.size(), kNoIndex),
          from_(graph.edges.size(), kNoIndex) {
        at_.resize(graph.places.size());
        for (std::uint32_t e = 0; e < graph.edges.size(); ++e) {
            const Edge& edge = graph.edges[e];
            if (edge.points.size() < 2) continue;
            for (const std::uint32_t node : edge.nodes) at_[node].push_back(e);
            width_.resize(graph.edges.size(), 0);
            width_[e] = compute_width(edge);
        }
    }

    std::vector<TracedSection> run() {
        const std::uint32_t lowest = find_lowest_node();
        if (lowest == kNoIndex) return {};
        walk_from(lowest);
        std::vector<TracedSection> out;
        std::vector<std::uint32_t> section(graph_.edges.size(), kNoIndex);
        for (const std::uint32_t e : order_) {
            section[e] = static_cast<std::uint32_t>(out.size());
            const auto& nodes = graph_.edges[e].nodes;
            const std::uint32_t end = nodes[0] == from_[e] ? nodes[1] : nodes[0];
            TracedSection made{.points = points_from(e, from_[e]),
                               .radius = graph_.places[from_[e]].radius,
                               .before = {},
                               .is_tip = at_[end].size() == 1};
            if (before_[e] != kNoIndex) made.before = section[before_[e]];
            out.push_back(std::move(made));
        }
        return out;
    }

  private:
    double compute_width(const Edge& edge) const {
        return 2 * radius_at(edge.points[edge.points.size() / 2], mask_, distance_);
    }

    /// Returns the place closest to the lowest pixels that are too thick for a twig or leaf.
    std::uint32_t find_lowest_node() const {
        const float thick = kStemWidth * *std::ranges::max_element(distance_);
        PicturePoint ground;
        for (int y = mask_.height - 1; y >= 0 && ground.y == 0; --y)
            for (int x = 0; x < mask_.width; ++x)
                if (distance_[mask_.index(x, y)] >= thick) ground = {x + 0.5, y + 0.5};
        std::uint32_t nearest = kNoIndex;
        for (std::uint32_t n = 0; n < graph_.places.size(); ++n) {
            if (at_[n].empty()) continue;
            const auto away = [&](std::uint32_t place) {
                return length(graph_.places[place].place - ground);
            };
            if (nearest == kNoIndex || away(n) < away(nearest)) nearest = n;
        }
        return nearest;
    }

    /// Returns the points of an edge, beginning at one of its nodes.
    std::vector<PicturePoint> points_from(std::uint32_t e, std::uint32_t node) const {
        std::vector<PicturePoint> points = graph_.edges[e].points;
        if (graph_.edges[e].nodes[0] != node) std::ranges::reverse(points);
        return points;
    }

    /// Returns the unit vector in which an edge leaves a node, measured outside the width of the node.
    PicturePoint leaving(std::uint32_t e, std::uint32_t node) const {
        const std::vector<PicturePoint> points = points_from(e, node);
        const double near = graph_.places[node].radius, far = 3 * near + 6;
        PicturePoint a = points.front(), b = points.back();
        double along = 0;
        for (std::size_t i = 1; i < points.size(); ++i) {
            along += length(points[i] - points[i - 1]);
            if (along <= near) a = points[i];
            b = points[i];
            if (along >= far) break;
        }
        if (length(b - a) < 1e-6) a = points.front();
        const PicturePoint d = b - a;
        return d * (1 / std::max(length(d), 1e-9));
    }

    /// Returns the cost of continuing from one edge to another: 0 straight ahead.
    double turn_cost(std::uint32_t from, std::uint32_t to, std::uint32_t node) const {
        const double cosine = -dot(leaving(from, node), leaving(to, node));
        // Thinner branches may leave at any angle.
        const double ratio = width_[to] / width_[from], thinner = std::min(ratio * ratio, 1.0);
        return kTurnCost * thinner * (1 - cosine) + kThickCost * std::max(std::log2(ratio), 0.0);
    }

    /// Enters every edge from its cheapest predecessor.
    void walk_from(std::uint32_t lowest) {
        const double diagonal = std::hypot(mask_.width, mask_.height);
        using Entry = std::tuple<double, std::uint32_t, std::uint32_t,
                                 std::uint32_t>;  // cost, edge, node, previous edge
        std::priority_queue<Entry, std::vector<Entry>, std::greater<>> queue;
        for (const std::uint32_t e : at_[lowest]) queue.emplace(0, e, lowest, kNoIndex);
        while (!queue.empty()) {
            const auto [cost, e, node, before] = queue.top();
            queue.pop();
            if (from_[e] != kNoIndex) continue;
            from_[e] = node;
            before_[e] = before;
            order_.push_back(e);
            const auto& nodes = graph_.edges[e].nodes;
            const std::uint32_t end = nodes[0] == node ? nodes[1] : nodes[0];
            const double length = compute_length(graph_.edges[e].points);
            for (const std::uint32_t next : at_[end])
                if (from_[next] == kNoIndex)
                    queue.emplace(cost + length + diagonal * turn_cost(e, next, end), next, end, e);
        }
    }

    const LineGraph& graph_;
    const Mask& mask_;
    const std::vector<float>& distance_;
    std::vector<std::vector<std::uint32_t>> at_;  ///< edges by place
    std::vector<double> width_;                   ///< [pixels] by edge
    std::vector<std::uint32_t> before_,
        from_;                          ///< by edge: its predecessor, and the place where it is entered
    std::vector<std::uint32_t> order_;  ///< edges in the order in which they were entered
};

/// Averages every point over its neighbourhood.
std::vector<PicturePoint> smoothed(const std::vector<PicturePoint>& line) {
    std::vector<PicturePoint> out;
    const int n = static_cast<int>(line.size());
    for (int i = 0; i < n; ++i) {
        const int reach = std::min({kSmooth, i, n - 1 - i});
        PicturePoint sum{};
        for (int k = i - reach; k <= i + reach; ++k) sum = sum + line[static_cast<std::size_t>(k)];
        out.push_back(sum * (1.0 / (2 * reach + 1)));
    }
    return out;
}

/// Removes the beginning of a medial axis, which runs into a corner of a flat base or into roots.
void straighten_base(std::vector<PicturePoint>& line, const Mask& mask, const std::vector<float>& distance) {
    const double wide = radius_at(line[line.size() / 8], mask, distance);
    double along = 0;
    std::size_t first = 0;
    while (first + 2 < line.size() / 4 && along < 2 * wide)
        along += length(line[first + 1] - line[first]), ++first;
    line.erase(line.begin(), line.begin() + static_cast<std::ptrdiff_t>(first));
}

/// Returns the point on the ground below a line that was shortened at the base.
std::optional<PicturePoint> ground_below(const std::vector<PicturePoint>& line, const Mask& mask) {
    const PicturePoint back = line.front() - line[std::min<std::size_t>(line.size() - 1, 60)];
    const double size = length(back);
    if (size < 1e-6) return std::nullopt;
    PicturePoint at = line.front();
    while (mask.at(static_cast<int>(at.x), static_cast<int>(at.y))) at = at + back * (1 / size);
    return length(at - line.front()) < 2 ? std::nullopt : std::optional(at);
}

}  // namespace

std::vector<TracedSection> find_paths(const LineGraph& graph, const Mask& mask,
                                      const std::vector<float>& distance) {
    return Walker(graph, mask, distance).run();
}

Stroke stroke_along(std::span<const TracedSection> sections, std::span<const std::uint32_t> chain,
                    const Mask& mask, const std::vector<float>& distance) {
    std::vector<PicturePoint> line;
    for (const std::uint32_t section : chain) {
        const auto& points = sections[section].points;
        line.insert(line.end(), points.begin() + (line.empty() ? 0 : 1), points.end());
    }
    line = smoothed(line);
    const bool from_base = !sections[chain.front()].before;
    if (from_base) straighten_base(line, mask, distance);
    const double near = from_base ? 0 : 1.5 * sections[chain.front()].radius;
    Stroke out;
    if (const auto ground = from_base ? ground_below(line, mask) : std::nullopt) {
        out.points.push_back(*ground);
        out.widths.push_back(2 * radius_at(line.front(), mask, distance));
    }
    double along = 0, since = kSpacing;
    for (std::size_t i = 0; i < line.size(); ++i) {
        const double step = i > 0 ? length(line[i] - line[i - 1]) : 0;
        along += step;
        since += step;
        if (since < kSpacing && i + 1 < line.size()) continue;
        since = 0;
        out.points.push_back(line[i]);
        // Within the width of its parent, the own width of a line is unknown: 0 until it is filled in below.
        out.widths.push_back(along < near ? 0 : 2 * radius_at(line[i], mask, distance));
    }
    double known = 2 * radius_at(line.back(), mask, distance);
    for (auto w = out.widths.rbegin(); w != out.widths.rend(); ++w) known = *w = *w > 0 ? *w : known;
    return out;
}

}  // namespace coppice::sketch_internal
