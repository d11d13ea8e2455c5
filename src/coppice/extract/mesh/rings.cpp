#include "coppice/extract/mesh/rings_internal.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "coppice/base/id.h"
#include "coppice/extract/mesh/ring_measure_internal.h"

namespace coppice::extract_internal {
namespace {

constexpr double kSpacing = 0.4;  // [radius] distance between rings
constexpr double kCap = 1.5;  // [radius] length of the cap at an end; the ring of a ball reaches the radius
                              // at pi / 2 from the pole
constexpr double kSourceCap = 2.2;  // [radius] length of the cap at a source; at the rim of a flat end the
                                    // opposite side is two radii away
// [radius] minimum length of a branch without rings; a flat bump is about as long as wide
constexpr double kSlimmest = 1.25;
constexpr double kPathShare = 0.3;  // [distance between two vertices] minimum distance of rings; closer rings
                                    // contain no new information
constexpr double kMinRadius = 0.01;  // [mean edge] minimum radius; thinner rings are degenerate folds
// number of steps per triangle after which the distance of rings increases
constexpr std::size_t kBudget = 32;

double mean_edge(const Surface& s) {
    double sum = 0;
    for (std::uint32_t h = 0; h < s.twin.size(); ++h)
        sum += distance(Vec3d(s.positions[s.from(h)]), Vec3d(s.positions[s.to(h)]));
    return sum / static_cast<double>(s.twin.size());
}

/// State of the traversal: the surface, the rings found so far and the current ring.
struct Walk {
    const Surface& surface;
    std::span<const double> distance;   // [m] distance from the source per vertex
    std::span<const char> from_border;  // per component
    double min_radius;                  // [m]
    RingForest out;
    std::vector<std::uint32_t> path;        // next vertex on the path of a chain, per vertex
    std::vector<Vec3d> points = {};         // points of the current ring
    std::vector<std::uint32_t> upper = {};  // upper ends of the edges that the current ring crosses
    std::uint32_t met = kNoIndex;  // a vertex on the path of another chain that the current ring crosses
    bool closed = false;
    std::size_t steps = 0;  // number of crossings of all rings so far
    std::vector<std::uint32_t> stack = {};
};

/// Returns whether a is closer to the source.
bool nearer(const Walk& walk, std::uint32_t a, std::uint32_t b) {
    return walk.distance[a] != walk.distance[b] ? walk.distance[a] < walk.distance[b] : a < b;
}

template <class Visit>
void for_neighbours(const Surface& s, std::uint32_t v, const Visit& visit) {
    for (const std::uint32_t h : s.outgoing(v)) {
        visit(s.to(h));
        visit(s.from(previous_half_edge<3>(h)));
    }
}

/// Returns the neighbour in the direction of steepest descent; v itself at a source.
std::uint32_t descend(const Walk& walk, std::uint32_t v) {
    std::uint32_t best = v;
    double slope = 0;
    for_neighbours(walk.surface, v, [&](std::uint32_t w) {
        if (!nearer(walk, w, v)) return;
        const double l = distance(Vec3d(walk.surface.positions[v]), Vec3d(walk.surface.positions[w]));
        const double g = (walk.distance[v] - walk.distance[w]) / std::max(l, 1e-300);
        if (best == v || g > slope) {
            best = w;
            slope = g;
        }
    });
    return best;
}

/// Returns the last ring towards the source with at least the given level; edges may span many rings.
std::uint32_t ring_at(std::span<const Ring> rings, std::uint32_t ring, double level) {
    while (rings[ring].parent != kNoIndex && rings[rings[ring].parent].level >= level)
        ring = rings[ring].parent;
    return ring;
}

std::uint32_t half_edge(const Surface& s, std::uint32_t v, std::uint32_t w) {
    for (const std::uint32_t h : s.outgoing(v)) {
        if (s.to(h) == w) return h;
        if (s.from(previous_half_edge<3>(h)) == w) return previous_half_edge<3>(h);
    }
    return kNoIndex;
}

/// Adds the point where the ring crosses an edge.
void cross_edge(Walk& walk, std::uint32_t h, double level) {
    const std::uint32_t a = walk.surface.from(h), b = walk.surface.to(h);
    const std::uint32_t up = walk.distance[a] >= level ? a : b, down = up == a ? b : a;
    const double t = (level - walk.distance[down]) / (walk.distance[up] - walk.distance[down]);
    walk.points.push_back(lerp(Vec3d(walk.surface.positions[down]), Vec3d(walk.surface.positions[up]), t));
    walk.upper.push_back(up);
    if (walk.path[up] == down) walk.met = up;
    ++walk.steps;
}

/// Adds the crossings from h on, triangle by triangle; returns true if it arrives at h again, false at a
/// border.
bool cross_triangles(Walk& walk, std::uint32_t start, double level) {
    std::uint32_t h = start;
    for (std::size_t guard = 0; guard <= walk.surface.triangles.size(); ++guard) {
        cross_edge(walk, h, level);
        const bool next_is_upper = walk.distance[walk.surface.to(next_half_edge<3>(h))] >= level;
        const bool same = next_is_upper == (walk.distance[walk.surface.to(h)] >= level);
        const std::uint32_t exit = same ? previous_half_edge<3>(h) : next_half_edge<3>(h);
        h = walk.surface.twin[exit];
        if (h == kNoIndex) {
            cross_edge(walk, exit, level);
            return false;
        }
        if (h == start) return true;
    }
    return true;
}

/// Traces the complete ring through the half-edge `start`.
void trace_ring(Walk& walk, std::uint32_t start, double level) {
    walk.points.clear();
    walk.upper.clear();
    walk.met = kNoIndex;
    walk.closed = cross_triangles(walk, start, level);
    if (walk.closed || walk.surface.twin[start] == kNoIndex) return;
    std::reverse(walk.points.begin(), walk.points.end());
    walk.points.pop_back();
    cross_triangles(walk, walk.surface.twin[start], level);
}

/// Claims the vertices between the ring just traced and the level `top`.
void flood(Walk& walk, std::uint32_t ring, double level, double top) {
    const auto claim = [&](std::uint32_t v) {
        if (walk.out.claim[v] != kNoIndex || walk.distance[v] < level || walk.distance[v] >= top) return;
        walk.out.claim[v] = ring;
        walk.stack.push_back(v);
    };
    for (const std::uint32_t v : walk.upper) claim(v);
    while (!walk.stack.empty()) {
        const std::uint32_t v = walk.stack.back();
        walk.stack.pop_back();
        for_neighbours(walk.surface, v, claim);
    }
}

/// Adds the ring just traced to the chain that begins with ring `first`.
void add_ring(Walk& walk, Ring ring, double top, std::uint32_t first) {
    const auto id = static_cast<std::uint32_t>(walk.out.rings.size());
    if (id > first) walk.out.rings.back().parent = id;
    walk.out.rings.push_back(ring);
    flood(walk, id, ring.level, top);
}

/// Closes a chain that ran into ring `end` or into the source. A chain without rings is merged into the one
/// that it ran into.
void close_chain(Walk& walk, RingChain chain, std::span<const std::uint32_t> path, std::uint32_t last,
                 std::uint32_t end) {
    const bool own = chain.end > chain.first;
    const std::uint32_t owner = own ? chain.end - 1 : end;
    if (owner == kNoIndex) return;
    for (const std::uint32_t u : path)
        if (walk.out.claim[u] == kNoIndex) walk.out.claim[u] = owner;
    if (!own) return;
    for (std::size_t k = 0; k < path.size(); ++k)
        walk.path[path[k]] = k + 1 < path.size() ? path[k + 1] : last;
    walk.out.rings.back().parent = end;
    walk.out.chains.push_back(chain);
}

/// Returns the distance of a ring from the ends of its chain, in radii: smaller for a ring of a cap than for
/// a cross-section.
double compute_slimness(const Walk& walk, const Ring& ring, std::uint32_t tip) {
    if (!(ring.radius > walk.min_radius)) return 0;
    const double from_tip = walk.distance[tip] - ring.level;
    const bool open_base = walk.from_border[walk.surface.component[tip]] != 0;
    return (open_base ? from_tip : std::min(from_tip, ring.level * kCap / kSourceCap)) / ring.radius;
}

/// Returns the distance to the next ring, between two vertices with distances that differ by `drop`. It
/// increases when the traversal has used more than its budget.
double ring_spacing(const Walk& walk, const Ring& ring, double drop) {
    const std::size_t over = walk.steps / kBudget;
    const double strain = 1 + static_cast<double>(over) / static_cast<double>(walk.surface.triangles.size());
    return strain * strain * std::max({kSpacing * ring.radius, kPathShare * drop, walk.min_radius});
}

/// Follows a chain from an unclaimed vertex.
void follow_chain(Walk& walk, std::uint32_t tip) {
    constexpr double kInfinity = std::numeric_limits<double>::infinity();
    RingChain chain{static_cast<std::uint32_t>(walk.out.rings.size()), 0, tip, kNoIndex};
    for_neighbours(walk.surface, tip, [&](std::uint32_t x) {
        if (nearer(walk, tip, x) && walk.out.claim[x] != kNoIndex) chain.touched = walk.out.claim[x];
    });
    std::uint32_t v = tip, w = descend(walk, tip), end = kNoIndex;
    std::vector<std::uint32_t> path{tip};
    double level = walk.distance[v] - 0.25 * (walk.distance[v] - walk.distance[w]), top = kInfinity,
           slimness = 0;
    Ring slimmest;
    while (w != v) {
        if (!(walk.distance[w] < level)) {
            v = w;
            w = descend(walk, v);
            if (walk.path[v] != kNoIndex) {
                end = ring_at(walk.out.rings, walk.out.claim[v], level);
                break;
            }
            path.push_back(v);
            continue;
        }
        trace_ring(walk, half_edge(walk.surface, v, w), level);
        if (walk.met != kNoIndex) {
            end = ring_at(walk.out.rings, walk.out.claim[walk.met], level);
            break;
        }
        Ring ring = measure_ring(walk.points, walk.closed);
        ring.level = level;
        const double slim = compute_slimness(walk, ring, tip);
        if (slim > slimness) {
            slimness = slim;
            slimmest = ring;
        }
        // Rings of the caps at both ends are not cross-sections.
        if (slim >= kCap) {
            add_ring(walk, ring, top, chain.first);
            top = level;
        }
        level -= ring_spacing(walk, ring, walk.distance[v] - walk.distance[w]);
    }
    if (walk.out.rings.size() == chain.first &&
        (slimness >= kSlimmest || (end == kNoIndex && slimness > 0))) {
        walk.upper.assign(1, tip);
        add_ring(walk, slimmest, kInfinity, chain.first);
    }
    chain.end = static_cast<std::uint32_t>(walk.out.rings.size());
    if (chain.end == chain.first && end != kNoIndex) {
        walk.upper.assign(1, tip);
        flood(walk, end, std::max(level, 0.0), kInfinity);
    }
    close_chain(walk, chain, path, w, end);
}

}  // namespace

RingForest follow_chains(const Surface& s, std::span<const double> f, std::span<const char> from_border,
                         const Context& ctx) {
    std::vector<std::uint32_t> order;
    for (std::uint32_t v = 0; v < s.size(); ++v)
        if (std::isfinite(f[v])) order.push_back(v);
    std::sort(order.begin(), order.end(),
              [&](std::uint32_t a, std::uint32_t b) { return f[a] != f[b] ? f[a] > f[b] : a > b; });
    Walk walk{
        s, f, from_border, kMinRadius * mean_edge(s), {}, std::vector<std::uint32_t>(s.size(), kNoIndex)};
    walk.out.claim.resize(s.size(), kNoIndex);
    std::size_t passed = 0;
    for (const std::uint32_t v : order) {
        ++passed;
        if (walk.out.claim[v] != kNoIndex) continue;
        ctx.throw_if_cancelled();
        ctx.report(static_cast<float>(passed) / static_cast<float>(order.size()));
        follow_chain(walk, v);
    }
    return std::move(walk.out);
}

}  // namespace coppice::extract_internal
