#include "coppice/extract/mesh/collapse_internal.h"
#include "coppice/extract/stage_internal.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <queue>

namespace coppice::extract_internal {
namespace {

constexpr double kSampling = 0.1;  // weight of lengths against the shape [Au2008]

/// The squared distance to a set of lines, as a quadratic form: p A p + 2 b p + c.
struct Quadric {
    double xx = 0, xy = 0, xz = 0, yy = 0, yz = 0, zz = 0;
    Vec3d b;
    double c = 0;

    /// Adds the line through p along the unit vector d: |x - p|^2 - (d . (x - p))^2.
    void add_line(Vec3d p, Vec3d d) {
        xx += 1 - d.x * d.x, yy += 1 - d.y * d.y, zz += 1 - d.z * d.z;
        xy -= d.x * d.y, xz -= d.x * d.z, yz -= d.y * d.z;
        const double along = dot(p, d);
        b += d * along - p;
        c += length_squared(p) - along * along;
    }
    void add(const Quadric& q) {
        xx += q.xx, xy += q.xy, xz += q.xz, yy += q.yy, yz += q.yz, zz += q.zz;
        b += q.b;
        c += q.c;
    }
    double at(Vec3d p) const {
        const Vec3d ap{xx * p.x + xy * p.y + xz * p.z, xy * p.x + yy * p.y + yz * p.z,
                       xz * p.x + yz * p.y + zz * p.z};
        return std::max(0.0, dot(p, ap) + 2 * dot(b, p) + c);
    }
};

class Collapser {
  public:
    Collapser(const Surface& s, std::span<const Vec3d> at);
    void run(const Context& ctx);
    Contraction result() const;

  private:
    struct Move {
        double cost;
        std::uint32_t from, to;
        std::uint32_t stamp;  // of both ends together: a later change makes the move stale
    };
    struct Dearer {
        bool operator()(const Move& a, const Move& b) const {
            if (a.cost != b.cost) return a.cost > b.cost;
            return a.from != b.from ? a.from > b.from : a.to > b.to;
        }
    };
    void offer(std::uint32_t i);
    void collapse(std::uint32_t i, std::uint32_t j);
    std::uint32_t find(std::uint32_t v) const {
        while (into_[v] != v) v = into_[v];
        return v;
    }

    const Surface& s_;
    std::span<const Vec3d> at_;
    std::vector<std::vector<std::uint32_t>> neighbours_;  // sorted
    std::vector<std::vector<std::uint32_t>> faces_;       // per vertex, live ones
    std::vector<Triangle> triangles_;
    std::vector<Quadric> quadric_;
    std::vector<std::uint32_t> into_;  // what a vertex became part of; itself while it is there
    std::vector<std::uint32_t> stamp_;
    std::priority_queue<Move, std::vector<Move>, Dearer> queue_;
};

void insert_sorted(std::vector<std::uint32_t>& list, std::uint32_t v) {
    const auto at = std::lower_bound(list.begin(), list.end(), v);
    if (at == list.end() || *at != v) list.insert(at, v);
}
void erase_sorted(std::vector<std::uint32_t>& list, std::uint32_t v) {
    const auto at = std::lower_bound(list.begin(), list.end(), v);
    if (at != list.end() && *at == v) list.erase(at);
}

Collapser::Collapser(const Surface& s, std::span<const Vec3d> at)
    : s_(s),
      at_(at),
      neighbours_(s.size()),
      faces_(s.size()),
      triangles_(s.triangles),
      quadric_(s.size()),
      into_(s.size()),
      stamp_(s.size(), 0) {
    for (std::uint32_t t = 0; t < triangles_.size(); ++t)
        for (const std::uint32_t v : triangles_[t]) faces_[v].push_back(t);
    for (std::uint32_t v = 0; v < s.size(); ++v) {
        into_[v] = v;
        for (const std::uint32_t h : s.outgoing(v)) {
            neighbours_[v].push_back(s.to(h));
            neighbours_[v].push_back(s.from(Surface::previous(h)));
        }
        std::sort(neighbours_[v].begin(), neighbours_[v].end());
        neighbours_[v].erase(std::unique(neighbours_[v].begin(), neighbours_[v].end()), neighbours_[v].end());
        for (const std::uint32_t w : neighbours_[v]) {
            const Vec3d d = at[w] - at[v];
            if (length_squared(d) > 0) quadric_[v].add_line(at[v], normalized(d));
        }
    }
}

/// The cheapest move of i onto a vertex that it shares a triangle with.
void Collapser::offer(std::uint32_t i) {
    double lengths = 0;
    for (const std::uint32_t k : neighbours_[i]) lengths += distance(at_[i], at_[k]);
    Move best{0, i, kNone, stamp_[i]};
    for (const std::uint32_t t : faces_[i]) {
        for (const std::uint32_t j : triangles_[t]) {
            if (j == i) continue;
            const double c = quadric_[i].at(at_[j]) + quadric_[j].at(at_[j]) +
                             kSampling * distance(at_[i], at_[j]) * lengths;
            if (best.to != kNone && (c > best.cost || (c == best.cost && j >= best.to))) continue;
            best.cost = c;
            best.to = j;
        }
    }
    if (best.to != kNone) queue_.push(best);
}

void Collapser::collapse(std::uint32_t i, std::uint32_t j) {
    for (const std::uint32_t t : faces_[i]) {
        Triangle& corners = triangles_[t];
        const bool dies = std::find(corners.begin(), corners.end(), j) != corners.end();
        if (dies) {
            for (const std::uint32_t v : corners)
                if (v != i) std::erase(faces_[v], t);
            continue;
        }
        std::replace(corners.begin(), corners.end(), i, j);
        Triangle key = corners;
        std::sort(key.begin(), key.end());
        const bool doubled = std::any_of(faces_[j].begin(), faces_[j].end(), [&](std::uint32_t other) {
            Triangle k = triangles_[other];
            std::sort(k.begin(), k.end());
            return k == key;
        });
        if (doubled) {
            for (const std::uint32_t v : corners)
                if (v != j) std::erase(faces_[v], t);
        } else {
            faces_[j].push_back(t);
        }
    }
    faces_[i].clear();
    for (const std::uint32_t k : neighbours_[i]) {
        erase_sorted(neighbours_[k], i);
        if (k == j) continue;
        insert_sorted(neighbours_[k], j);
        insert_sorted(neighbours_[j], k);
    }
    neighbours_[i].clear();
    quadric_[j].add(quadric_[i]);
    into_[i] = j;
}

void Collapser::run(const Context& ctx) {
    constexpr std::size_t kPoll = 256;
    for (std::uint32_t v = 0; v < s_.size(); ++v) {
        poll_stop(ctx, v);
        offer(v);
    }
    std::size_t collapsed = 0;
    for (std::size_t step = 0; !queue_.empty(); ++step) {
        if (step % kPoll == 0) {
            ctx.throw_if_cancelled();
            ctx.report(static_cast<float>(collapsed) / static_cast<float>(s_.size()));
        }
        const Move move = queue_.top();
        queue_.pop();
        if (into_[move.from] != move.from || stamp_[move.from] != move.stamp) continue;
        collapse(move.from, move.to);
        ++collapsed;
        // Every neighbour of the place has a new cost.
        std::vector<std::uint32_t> changed = neighbours_[move.to];
        changed.push_back(move.to);
        for (const std::uint32_t v : changed) {
            ++stamp_[v];
            offer(v);
        }
    }
}

Contraction Collapser::result() const {
    Contraction out;
    std::vector<std::uint32_t> lowest(s_.component_count, kNone), node(s_.size(), kNone), queue;
    for (std::uint32_t v = 0; v < s_.size(); ++v) {
        std::uint32_t& best = lowest[s_.component[v]];
        if (best == kNone || s_.positions[v].z < s_.positions[best].z) best = v;
    }
    for (const std::uint32_t low : lowest) {
        queue.assign(1, find(low));
        node[queue[0]] = out.tree.add(DraftTree::kNoParent, at_[queue[0]], 1);
        for (std::size_t k = 0; k < queue.size(); ++k) {
            for (const std::uint32_t w : neighbours_[queue[k]]) {
                if (node[w] != kNone) continue;
                node[w] = out.tree.add(node[queue[k]], at_[w], 1);
                queue.push_back(w);
            }
        }
        for (const std::uint32_t v : queue)
            for (const std::uint32_t w : neighbours_[v])
                if (v < w && out.tree.parent[node[v]] != node[w] && out.tree.parent[node[w]] != node[v])
                    out.loops.push_back({node[v], node[w]});
    }
    out.node.resize(s_.size());
    for (std::uint32_t v = 0; v < s_.size(); ++v) out.node[v] = node[find(v)];
    return out;
}

}  // namespace

Contraction collapse_to_graph(const Surface& surface, std::span<const Vec3d> at, const Context& ctx) {
    Collapser collapser(surface, at);
    collapser.run(ctx);
    return collapser.result();
}

}  // namespace coppice::extract_internal
