#include "coppice/skeleton/simplify_chain.h"

#include <algorithm>
#include <cmath>
#include <optional>
#include <utility>

namespace coppice {
namespace {

constexpr double kJump = 0.2f;  // relative change of radius above which two close nodes are kept

struct Interval {
    std::uint32_t first, last;
    int depth;
};

/// Returns the relative shift of the ball at p if the points between a and b are removed.
double compute_shift(const ChainPoint& p, const ChainPoint& a, const ChainPoint& b) {
    const Vec3d way = b.position - a.position;
    const double widening = b.radius - a.radius;
    const Vec3d to = p.position - a.position;
    const double square = dot(way, way) + widening * widening;
    const double along = dot(to, way) + (p.radius - a.radius) * widening;
    const double t = square > 0 ? std::clamp(along / square, 0.0, 1.0) : 0.0;
    const double d_radius = p.radius - a.radius - t * widening;
    return std::sqrt(length_squared(to - way * t) + d_radius * d_radius) / p.radius;
}

std::pair<std::uint32_t, double> find_farthest(const std::vector<ChainPoint>& points, const Interval& in,
                                               bool leads) {
    std::pair<std::uint32_t, double> best{in.first, -1};
    ChainPoint a = points[in.first];
    // The first segment of a lateral has the radius of its end throughout.
    if (in.first == 0 && !leads) a.radius = points[in.last].radius;
    for (std::uint32_t i = in.first + 1; i < in.last; ++i) {
        const double shift = compute_shift(points[i], a, points[in.last]);
        if (shift > best.second) best = {i, shift};
    }
    return best;
}

/// Chooses points by Douglas-Peucker in four dimensions, with an explicit stack. Deep intervals are split in
/// half instead of at their farthest point: this bounds the worst case by O(n log n), at the cost of a few
/// additional points.
std::vector<bool> choose_points(std::vector<ChainPoint>& points, const ChainRule& rule) {
    const auto last = static_cast<std::uint32_t>(points.size() - 1);
    std::vector<bool> chosen(points.size(), false);
    chosen[0] = chosen[last] = true;
    const int deepest = 16 + 2 * static_cast<int>(std::log2(points.size()));
    std::vector<Interval> stack{{0, last, 0}};
    while (!stack.empty()) {
        const Interval in = stack.back();
        stack.pop_back();
        const auto [farthest, shift] = find_farthest(points, in, rule.leads);
        if (!(shift > rule.tolerance)) continue;
        const std::uint32_t at = in.depth < deepest ? farthest : in.first + (in.last - in.first) / 2;
        chosen[at] = true;
        points[at].influence = shift;
        stack.push_back({at, in.last, in.depth + 1});
        stack.push_back({in.first, at, in.depth + 1});
    }
    return chosen;
}

bool is_jump(const ChainPoint& a, const ChainPoint& b) {
    return std::abs(a.radius - b.radius) > kJump * std::max(a.radius, b.radius);
}

/// Returns whether two points are too close and have similar radii.
bool crowd(const ChainPoint& a, const ChainPoint& b, double spacing) {
    return distance(a.position, b.position) < spacing * std::min(a.radius, b.radius) && !is_jump(a, b);
}

/// Adds a point to the kept ones; it replaces close points with less influence, or is omitted.
void add_spaced(std::vector<ChainPoint>& out, const ChainPoint& p, double spacing) {
    while (crowd(out.back(), p, spacing)) {
        if (out.size() == 1 || out.back().influence >= p.influence) return;
        out.pop_back();
    }
    out.push_back(p);
}

/// Returns a point moved along the segment to the next one until its distance to the previous one is `away`
/// [m]; nullopt if that needs more than half of the segment.
std::optional<ChainPoint> moved_on(ChainPoint p, const ChainPoint& before, const ChainPoint& next,
                                   double away) {
    const Vec3d from = p.position - before.position, way = next.position - p.position;
    // Solves |from + t way| = away: the larger root of a quadratic equation.
    const double a = length_squared(way), b = dot(from, way), c = length_squared(from) - away * away;
    if (!(a > 0) || c >= 0) return {};
    const double t = (std::sqrt(b * b - a * c) - b) / a;
    if (!(t <= 0.5)) return {};
    p.position += way * t;
    return p;
}

SimplifiedChain space_out(const std::vector<ChainPoint>& points, const std::vector<bool>& chosen,
                          const ChainRule& rule) {
    SimplifiedChain out{{points[0]}};
    std::vector<ChainPoint>& kept = out.points;
    for (std::size_t i = 1; i + 1 < points.size(); ++i) {
        if (!chosen[i]) continue;
        const ChainPoint& p = points[i];
        const ChainPoint& next = points[static_cast<std::size_t>(
            std::find(chosen.begin() + static_cast<std::ptrdiff_t>(i) + 1, chosen.end(), true) -
            chosen.begin())];
        const ChainPoint& before = kept.back();
        const double ball = kept.size() == 1 ? rule.fork_ball : 0;
        const bool is_in_ball = distance(p.position, before.position) < ball;
        if (!is_in_ball && !crowd(before, p, rule.min_spacing)) {
            kept.push_back(p);
            continue;
        }
        if (compute_shift(p, before, next) > rule.max_shift) {
            const double spacing = rule.min_spacing * std::min(before.radius, p.radius);
            if (const auto moved = moved_on(p, before, next, std::max(ball, spacing))) {
                kept.push_back(*moved);
                ++out.moved;
                continue;
            }
        }
        if (!is_in_ball) add_spaced(kept, p, rule.min_spacing);
    }
    while (kept.size() > 1 && crowd(kept.back(), points.back(), rule.min_spacing)) kept.pop_back();
    kept.push_back(points.back());
    return out;
}

/// Moves the two ends of a jump in radius apart, each along its own segment and by at most a third of it.
/// Returns the number of moved points.
std::uint32_t spread_jumps(std::vector<ChainPoint>& chain, double spacing) {
    std::uint32_t moved = 0;
    const auto move = [&](std::size_t i, std::size_t toward, double way) {
        const Vec3d to = chain[toward].position - chain[i].position;
        const double l = length(to);
        if (l <= 0) return 0.0;
        const double step = std::min(way, l / 3);
        chain[i].position += to * (step / l);
        ++moved;
        return step;
    };
    for (std::size_t i = 0; i + 1 < chain.size(); ++i) {
        if (!is_jump(chain[i], chain[i + 1])) continue;
        double lacking = spacing * std::min(chain[i].radius, chain[i + 1].radius) -
                         distance(chain[i].position, chain[i + 1].position);
        if (!(lacking > 0)) continue;
        const bool back = i > 0, on = i + 2 < chain.size();
        if (back) lacking -= move(i, i - 1, on ? lacking / 2 : lacking);
        if (on && lacking > 0) move(i + 1, i + 2, lacking);
    }
    return moved;
}

}  // namespace

SimplifiedChain simplify_chain(std::vector<ChainPoint> points, const ChainRule& rule) {
    const std::vector<bool> chosen = choose_points(points, rule);
    SimplifiedChain out = space_out(points, chosen, rule);
    out.moved += spread_jumps(out.points, rule.min_spacing);
    return out;
}

}  // namespace coppice
