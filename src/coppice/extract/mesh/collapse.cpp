#include "coppice/extract/mesh/collapse_internal.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <queue>

#include "coppice/base/id.h"
#include "coppice/base/progress.h"
#include "coppice/base/sort.h"

namespace coppice::extract_internal {
namespace {

constexpr double kSampling = 0.1;  // weight of the edge lengths relative to the shape cost [Au2008]

/// Squared distance to a set of lines as a quadratic form: p A p + 2 b p + c.
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

struct Move {
    double cost;
    std::uint32_t from, to;
    std::uint32_t stamp;  // stamp of `from`; a later change invalidates the move
};
struct Dearer {
    bool operator()(const Move& a, const Move& b) const {
        if (a.cost != b.cost) return a.cost > b.cost;
        return a.from != b.from ? a.from > b.from : a.to > b.to;
    }
};

/// State of a surface during the edge collapses.
struct Remainder {
    std::span<const Vec3d> at;
    std::vector<std::vector<std::uint32_t>> neighbours;  // sorted
    std::vector<std::vector<std::uint32_t>> faces;       // remaining faces of each vertex
    std::vector<Triangle> triangles;
    std::vector<Quadric> quadric;
    std::vector<std::uint32_t> into;  // vertex that each vertex was merged into; itself if it remains
    std::vector<std::uint32_t> stamp;
    std::priority_queue<Move, std::vector<Move>, Dearer> queue;

    std::uint32_t find(std::uint32_t v) const {
        while (into[v] != v) v = into[v];
        return v;
    }
};

void insert_sorted(std::vector<std::uint32_t>& list, std::uint32_t v) {
    const auto at = std::lower_bound(list.begin(), list.end(), v);
    if (at == list.end() || *at != v) list.insert(at, v);
}
void erase_sorted(std::vector<std::uint32_t>& list, std::uint32_t v) {
    const auto at = std::lower_bound(list.begin(), list.end(), v);
    if (at != list.end() && *at == v) list.erase(at);
}

Remainder make_remainder(const Surface& s, std::span<const Vec3d> at) {
    const std::uint32_t size = s.size();
    Remainder r{at, {}, {}, s.triangles, {}, {}, std::vector<std::uint32_t>(size, 0), {}};
    r.neighbours.resize(size);
    r.faces.resize(size);
    r.quadric.resize(size);
    r.into.resize(size);
    for (std::uint32_t t = 0; t < r.triangles.size(); ++t)
        for (const std::uint32_t v : r.triangles[t]) r.faces[v].push_back(t);
    for (std::uint32_t v = 0; v < size; ++v) {
        r.into[v] = v;
        auto& neighbours = r.neighbours[v];
        for (const std::uint32_t h : s.outgoing(v)) {
            neighbours.push_back(s.to(h));
            neighbours.push_back(s.from(previous_half_edge<3>(h)));
        }
        sort_unique(neighbours);
        for (const std::uint32_t w : neighbours) {
            const Vec3d d = at[w] - at[v];
            if (length_squared(d) > 0) r.quadric[v].add_line(at[v], normalized(d));
        }
    }
    return r;
}

/// Adds the cheapest move of i onto a vertex of an adjacent triangle to the queue.
void offer(Remainder& r, std::uint32_t i) {
    double lengths = 0;
    for (const std::uint32_t k : r.neighbours[i]) lengths += distance(r.at[i], r.at[k]);
    Move best{0, i, kNoIndex, r.stamp[i]};
    for (const std::uint32_t t : r.faces[i]) {
        for (const std::uint32_t j : r.triangles[t]) {
            if (j == i) continue;
            const double c = r.quadric[i].at(r.at[j]) + r.quadric[j].at(r.at[j]) +
                             kSampling * distance(r.at[i], r.at[j]) * lengths;
            if (best.to != kNoIndex && (c > best.cost || (c == best.cost && j >= best.to))) continue;
            best.cost = c;
            best.to = j;
        }
    }
    if (best.to != kNoIndex) r.queue.push(best);
}

void collapse(Remainder& r, std::uint32_t i, std::uint32_t j) {
    for (const std::uint32_t t : r.faces[i]) {
        Triangle& corners = r.triangles[t];
        const bool dies = std::find(corners.begin(), corners.end(), j) != corners.end();
        if (dies) {
            for (const std::uint32_t v : corners)
                if (v != i) std::erase(r.faces[v], t);
            continue;
        }
        std::replace(corners.begin(), corners.end(), i, j);
        Triangle key = corners;
        std::sort(key.begin(), key.end());
        const bool doubled = std::any_of(r.faces[j].begin(), r.faces[j].end(), [&](std::uint32_t other) {
            Triangle k = r.triangles[other];
            std::sort(k.begin(), k.end());
            return k == key;
        });
        if (doubled) {
            for (const std::uint32_t v : corners)
                if (v != j) std::erase(r.faces[v], t);
        } else {
            r.faces[j].push_back(t);
        }
    }
    r.faces[i].clear();
    for (const std::uint32_t k : r.neighbours[i]) {
        erase_sorted(r.neighbours[k], i);
        if (k == j) continue;
        insert_sorted(r.neighbours[k], j);
        insert_sorted(r.neighbours[j], k);
    }
    r.neighbours[i].clear();
    r.quadric[j].add(r.quadric[i]);
    r.into[i] = j;
}

void collapse_all(Remainder& r, const Context& ctx) {
    constexpr std::size_t kPoll = 256;
    for (std::uint32_t v = 0; v < r.into.size(); ++v) {
        poll_stop(ctx, v);
        offer(r, v);
    }
    std::size_t collapsed = 0;
    for (std::size_t step = 0; !r.queue.empty(); ++step) {
        if (step % kPoll == 0) {
            ctx.throw_if_cancelled();
            ctx.report(static_cast<float>(collapsed) / static_cast<float>(r.into.size()));
        }
        const Move move = r.queue.top();
        r.queue.pop();
        if (r.into[move.from] != move.from || r.stamp[move.from] != move.stamp) continue;
        collapse(r, move.from, move.to);
        ++collapsed;
        // The costs of all neighbours of the target have changed.
        std::vector<std::uint32_t> changed = r.neighbours[move.to];
        changed.push_back(move.to);
        for (const std::uint32_t v : changed) {
            ++r.stamp[v];
            offer(r, v);
        }
    }
}

Contraction build_graph(const Surface& s, const Remainder& r) {
    Contraction out;
    std::vector<std::uint32_t> lowest(s.component_count, kNoIndex), node(s.size(), kNoIndex), queue;
    for (std::uint32_t v = 0; v < s.size(); ++v) {
        std::uint32_t& best = lowest[s.component[v]];
        if (best == kNoIndex || s.positions[v].z < s.positions[best].z) best = v;
    }
    for (const std::uint32_t low : lowest) {
        queue.assign(1, r.find(low));
        node[queue[0]] = out.tree.add(kNoIndex, r.at[queue[0]], 1);
        for (std::size_t k = 0; k < queue.size(); ++k) {
            for (const std::uint32_t w : r.neighbours[queue[k]]) {
                if (node[w] != kNoIndex) continue;
                node[w] = out.tree.add(node[queue[k]], r.at[w], 1);
                queue.push_back(w);
            }
        }
        for (const std::uint32_t v : queue)
            for (const std::uint32_t w : r.neighbours[v])
                if (v < w && out.tree.parent[node[v]] != node[w] && out.tree.parent[node[w]] != node[v])
                    out.loops.push_back({node[v], node[w]});
    }
    out.node.resize(s.size());
    for (std::uint32_t v = 0; v < s.size(); ++v) out.node[v] = node[r.find(v)];
    return out;
}

}  // namespace

Contraction collapse_to_graph(const Surface& surface, std::span<const Vec3d> at, const Context& ctx) {
    Remainder remainder = make_remainder(surface, at);
    collapse_all(remainder, ctx);
    return build_graph(surface, remainder);
}

}  // namespace coppice::extract_internal
