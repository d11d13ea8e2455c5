#include "coppice/extract/mesh/rings_internal.h"

#include <algorithm>
#include <cmath>

#include "coppice/base/parallel.h"
#include "coppice/extract/mesh/ring_measure_internal.h"

namespace coppice::extract_internal {
namespace {

constexpr double kSpacing = 0.4;       // [radius] between rings
constexpr double kCap = 1.5;           // [radius] a ball's ring reaches its radius at pi / 2 from the pole
constexpr double kSourceCap = 2.2;     // [radius] from the rim of a flat end the far side is two radii off
constexpr double kSlimmest = 1.25;     // a flat bump is about as long as it is wide
constexpr double kPathShare = 0.3;     // of the way between two vertices: rings closer tell nothing new
constexpr double kLeastRadius = 0.01;  // [mean edge] thinner rings are folds without an inside
constexpr std::size_t kBudget = 32;    // steps per triangle before rings move apart

class Follower {
  public:
    Follower(const Surface& s, std::span<const double> f, std::span<const char> from_border, RingForest& out)
        : s_(s), f_(f), from_border_(from_border), out_(out), path_(s.size(), kNone) {
        double sum = 0;
        for (std::uint32_t h = 0; h < s.twin.size(); ++h)
            sum += distance(Vec3d(s.positions[s.from(h)]), Vec3d(s.positions[s.to(h)]));
        least_radius_ = kLeastRadius * sum / static_cast<double>(s.twin.size());
    }

    /// A chain from a vertex that nothing has claimed yet.
    void follow(std::uint32_t tip);

  private:
    bool lower(std::uint32_t a, std::uint32_t b) const { return f_[a] != f_[b] ? f_[a] < f_[b] : a < b; }
    bool above(std::uint32_t v, double level) const { return f_[v] >= level; }
    template <class Visit>
    void for_neighbours(std::uint32_t v, const Visit& visit) const {
        for (const std::uint32_t h : s_.outgoing(v)) {
            visit(s_.to(h));
            visit(s_.from(Surface::previous(h)));
        }
    }
    std::uint32_t descend(std::uint32_t v) const;
    std::uint32_t half_edge(std::uint32_t v, std::uint32_t w) const;
    std::uint32_t ring_at(std::uint32_t ring, double level) const;
    void trace(std::uint32_t start, double level);
    bool walk(std::uint32_t h, double level);
    void cross(std::uint32_t h, double level);
    void take(Ring ring, double top, std::uint32_t first);
    void flood(std::uint32_t ring, double level, double top);
    void finish(RingChain chain, std::span<const std::uint32_t> way, std::uint32_t last, std::uint32_t end);

    const Surface& s_;
    std::span<const double> f_;
    std::span<const char> from_border_;
    RingForest& out_;
    std::vector<std::uint32_t> path_;   // where chains have gone: the next vertex, per vertex
    std::vector<Vec3d> points_;         // the ring being traced
    std::vector<std::uint32_t> upper_;  // upper ends of the edges that it crosses
    std::vector<std::uint32_t> stack_;
    std::uint32_t met_ = kNone;  // a vertex of another chain's path that the ring crosses
    bool closed_ = false;
    std::size_t steps_ = 0;
    double least_radius_ = 0;
};

/// The neighbour in the direction of steepest descent; v itself at a source.
std::uint32_t Follower::descend(std::uint32_t v) const {
    std::uint32_t best = v;
    double slope = 0;
    for_neighbours(v, [&](std::uint32_t w) {
        if (!lower(w, v)) return;
        const double l = distance(Vec3d(s_.positions[v]), Vec3d(s_.positions[w]));
        const double g = (f_[v] - f_[w]) / std::max(l, 1e-300);
        if (best == v || g > slope) {
            best = w;
            slope = g;
        }
    });
    return best;
}

/// From a ring on towards the source as far as rings lie above a level: edges may span many rings.
std::uint32_t Follower::ring_at(std::uint32_t ring, double level) const {
    while (out_.rings[ring].parent != kNone && out_.rings[out_.rings[ring].parent].level >= level)
        ring = out_.rings[ring].parent;
    return ring;
}

std::uint32_t Follower::half_edge(std::uint32_t v, std::uint32_t w) const {
    for (const std::uint32_t h : s_.outgoing(v)) {
        if (s_.to(h) == w) return h;
        if (s_.from(Surface::previous(h)) == w) return Surface::previous(h);
    }
    return kNone;
}

/// Adds the point where the ring crosses an edge.
void Follower::cross(std::uint32_t h, double level) {
    const std::uint32_t a = s_.from(h), b = s_.to(h);
    const std::uint32_t up = above(a, level) ? a : b, down = up == a ? b : a;
    const double t = (level - f_[down]) / (f_[up] - f_[down]);
    points_.push_back(lerp(Vec3d(s_.positions[down]), Vec3d(s_.positions[up]), t));
    upper_.push_back(up);
    if (path_[up] == down) met_ = up;
    ++steps_;
}

/// Adds the crossings from h on, triangle by triangle; true when it comes back to h, false at a border.
bool Follower::walk(std::uint32_t start, double level) {
    std::uint32_t h = start;
    for (std::size_t guard = 0; guard <= s_.triangles.size(); ++guard) {
        cross(h, level);
        const bool same = above(s_.to(Surface::next(h)), level) == above(s_.to(h), level);
        const std::uint32_t exit = same ? Surface::previous(h) : Surface::next(h);
        h = s_.twin[exit];
        if (h == kNone) {
            cross(exit, level);
            return false;
        }
        if (h == start) return true;
    }
    return true;
}

/// The whole ring through the half-edge `start`.
void Follower::trace(std::uint32_t start, double level) {
    points_.clear();
    upper_.clear();
    met_ = kNone;
    closed_ = walk(start, level);
    if (closed_ || s_.twin[start] == kNone) return;
    std::reverse(points_.begin(), points_.end());
    points_.pop_back();
    walk(s_.twin[start], level);
}

/// Claims what lies between the ring just traced and the level `top`.
void Follower::flood(std::uint32_t ring, double level, double top) {
    const auto claim = [&](std::uint32_t v) {
        if (out_.claim[v] != kNone || f_[v] < level || f_[v] >= top) return;
        out_.claim[v] = ring;
        stack_.push_back(v);
    };
    for (const std::uint32_t v : upper_) claim(v);
    while (!stack_.empty()) {
        const std::uint32_t v = stack_.back();
        stack_.pop_back();
        for_neighbours(v, claim);
    }
}

/// Adds the ring just traced to the chain whose rings begin at `first`.
void Follower::take(Ring ring, double top, std::uint32_t first) {
    const auto id = static_cast<std::uint32_t>(out_.rings.size());
    if (id > first) out_.rings.back().parent = id;
    out_.rings.push_back(ring);
    flood(id, ring.level, top);
}

void Follower::follow(std::uint32_t tip) {
    constexpr double kInfinity = std::numeric_limits<double>::infinity();
    RingChain chain{static_cast<std::uint32_t>(out_.rings.size()), 0, tip, kNone};
    for_neighbours(tip, [&](std::uint32_t x) {
        if (lower(tip, x) && out_.claim[x] != kNone) chain.touched = out_.claim[x];
    });
    std::uint32_t v = tip, w = descend(tip), end = kNone;
    std::vector<std::uint32_t> way{tip};
    const bool open_below = from_border_[s_.component[tip]] != 0;
    double level = f_[v] - 0.25 * (f_[v] - f_[w]), top = kInfinity, slimness = 0;
    Ring slimmest;
    while (w != v) {
        if (!(f_[w] < level)) {
            v = w;
            w = descend(v);
            if (path_[v] != kNone) {
                end = ring_at(out_.claim[v], level);
                break;
            }
            way.push_back(v);
            continue;
        }
        trace(half_edge(v, w), level);
        if (met_ != kNone) {
            end = ring_at(out_.claim[met_], level);
            break;
        }
        Ring ring = measure_ring(points_, closed_);
        ring.level = level;
        const double depth =
            open_below ? f_[tip] - level : std::min(f_[tip] - level, level * kCap / kSourceCap);
        const double slim = ring.radius > least_radius_ ? depth / ring.radius : 0;
        if (slim > slimness) {
            slimness = slim;
            slimmest = ring;
        }
        // Rings of the caps at either end are no sections.
        if (slim >= kCap) {
            take(ring, top, chain.first);
            top = level;
        }
        const std::size_t over = steps_ / kBudget;
        const double strain = 1 + static_cast<double>(over) / static_cast<double>(s_.triangles.size());
        level -=
            strain * strain * std::max({kSpacing * ring.radius, kPathShare * (f_[v] - f_[w]), least_radius_});
    }
    if (out_.rings.size() == chain.first && (slimness >= kSlimmest || (end == kNone && slimness > 0))) {
        upper_.assign(1, tip);
        take(slimmest, kInfinity, chain.first);
    }
    chain.end = static_cast<std::uint32_t>(out_.rings.size());
    if (chain.end == chain.first && end != kNone) {
        upper_.assign(1, tip);
        flood(end, std::max(level, 0.0), kInfinity);
    }
    finish(chain, way, w, end);
}

/// Closes a chain that ran into ring `end`, or into the source. Without a ring of its own it becomes part of
/// what it ran into.
void Follower::finish(RingChain chain, std::span<const std::uint32_t> way, std::uint32_t last,
                      std::uint32_t end) {
    const bool own = chain.end > chain.first;
    const std::uint32_t owner = own ? chain.end - 1 : end;
    if (owner == kNone) return;
    for (const std::uint32_t u : way)
        if (out_.claim[u] == kNone) out_.claim[u] = owner;
    if (!own) {
        return;
    }
    for (std::size_t k = 0; k < way.size(); ++k) path_[way[k]] = k + 1 < way.size() ? way[k + 1] : last;
    out_.rings.back().parent = end;
    out_.chains.push_back(chain);
}

}  // namespace

RingForest follow_chains(const Surface& s, std::span<const double> f, std::span<const char> from_border,
                         const Context& ctx) {
    constexpr std::size_t kPoll = 256;
    RingForest out;
    std::vector<std::uint32_t> order;
    for (std::uint32_t v = 0; v < s.size(); ++v)
        if (std::isfinite(f[v])) order.push_back(v);
    std::sort(order.begin(), order.end(),
              [&](std::uint32_t a, std::uint32_t b) { return f[a] != f[b] ? f[a] > f[b] : a > b; });
    out.claim.resize(s.size(), kNone);
    Follower follower(s, f, from_border, out);
    std::size_t started = 0;
    for (const std::uint32_t v : order) {
        if (out.claim[v] != kNone) continue;
        if (started++ % kPoll == 0) ctx.throw_if_cancelled();
        follower.follow(v);
    }
    return out;
}

}  // namespace coppice::extract_internal
