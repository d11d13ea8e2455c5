#include "coppice/pipeline/remesh/coarsen_triangles_internal.h"

#include <algorithm>
#include <array>
#include <numbers>
#include <utility>
#include <vector>

#include "coppice/base/id.h"

namespace coppice {
namespace {

constexpr float kShort = 0.6f, kLong = 2.6f;  // [spacings] lengths of edges that collapse, and of new ones
constexpr float kSameCorner = 0.5f;           // [spacings] maximum distance of corners that are the same
constexpr double kMinQuality = 0.01;          // of new triangles
constexpr double kPoor = 0.8, kGain = 0.05;   // qualities of triangles with edges to flip, and their gain
constexpr std::size_t kMinValence = 3, kMaxValence = 12;
constexpr std::size_t kQueues = 32;  // of edges sorted by length, in equal steps

// Returns the normal of a triangle, its length twice the area.
Vec3d area_normal(const std::array<Vec3, 3>& p) { return cross(Vec3d(p[1] - p[0]), Vec3d(p[2] - p[0])); }

// Returns 1 for an equilateral triangle, 0 for one without area.
double quality(const std::array<Vec3, 3>& p) {
    const auto squared = [](Vec3 v) { return dot(Vec3d(v), Vec3d(v)); };
    const double squares = squared(p[1] - p[0]) + squared(p[2] - p[1]) + squared(p[0] - p[2]);
    constexpr double kEquilateral = 2 * std::numbers::sqrt3;  // sum of squared edges over twice the area
    return squares > 0 ? kEquilateral * length(area_normal(p)) / squares : 0;
}

class Coarsening {
  public:
    Coarsening(TriMesh& mesh, std::span<const GridCorner> corners)
        : x_(mesh.positions), triangles_(mesh.triangles), corners_(corners), fan_(mesh.positions.size()) {
        for (const Triangle& t : triangles_) {
            for (const std::uint32_t v : t) ++fan_[v].size;
        }
        std::uint32_t begin = 0;
        for (Fan& f : fan_) {
            f.begin = begin;
            begin += std::exchange(f.size, 0u);
        }
        members_.resize(begin);
        for (std::uint32_t t = 0; t < triangles_.size(); ++t) {
            for (const std::uint32_t v : triangles_[t]) members_[fan_[v].begin + fan_[v].size++] = t;
        }
        for (const Triangle& t : triangles_) {
            for (std::size_t k = 0; k < 3; ++k) {
                if (t[k] < t[(k + 1) % 3]) add(t[k], t[(k + 1) % 3]);
            }
        }
    }

    void collapse_edges() {
        for (std::size_t first = 0; first < kQueues;) {
            if (queue_[first].empty()) {
                ++first;
                continue;
            }
            const Edge e = queue_[first].back();
            queue_[first].pop_back();
            first = std::min(first, collapse(e));
        }
    }

    void flip_edges() {
        constexpr int kPasses = 4;
        for (int pass = 0; pass < kPasses; ++pass) {
            bool changed = false;
            for (std::uint32_t t = 0; t < triangles_.size(); ++t) {
                if (triangles_[t][0] == kNoIndex || quality(points(triangles_[t])) >= kPoor) continue;
                const bool is_flipped = flip(t, 0) || flip(t, 1) || flip(t, 2);
                changed = changed || is_flipped;
            }
            if (!changed) return;
        }
    }

    bool is_used(std::uint32_t v) const { return fan_[v].size > 0; }

  private:
    struct Edge {
        std::uint32_t a, b;
    };
    struct Fan {
        std::uint32_t begin = 0, size = 0;  // in members_
    };

    // Returns the first queue with new edges.
    std::size_t collapse(Edge e) {
        if (!is_used(e.a) || !is_used(e.b) || !are_joined(e.a, e.b)) return kQueues;
        if (off_corner(e.a) < off_corner(e.b)) std::swap(e.a, e.b);
        if (can_move(e.a, e.b)) return move(e.a, e.b);
        return can_move(e.b, e.a) ? move(e.b, e.a) : kQueues;
    }

    std::span<const std::uint32_t> at(std::uint32_t v) const {
        return std::span(members_).subspan(fan_[v].begin, fan_[v].size);
    }

    float spacing(std::uint32_t a, std::uint32_t b) const {
        return std::min(corners_[a].spacing, corners_[b].spacing);
    }
    // [m] Returns the distance of a vertex from its corner.
    float off_corner(std::uint32_t v) const { return distance(x_[v], corners_[v].position); }

    // Queues an edge by its length; returns its queue.
    std::size_t add(std::uint32_t a, std::uint32_t b) {
        const float length = distance(x_[a], x_[b]), unit = spacing(a, b);
        const bool is_same = distance(corners_[a].position, corners_[b].position) <= kSameCorner * unit;
        if (!is_same && !(length < kShort * unit)) return kQueues;
        const auto q =
            length < kLong * unit ? static_cast<std::size_t>(length / (kLong * unit) * kQueues) : kQueues - 1;
        queue_[q].push_back({a, b});
        return q;
    }

    bool has(std::uint32_t t, std::uint32_t v) const {
        return std::ranges::find(triangles_[t], v) != triangles_[t].end();
    }

    bool are_joined(std::uint32_t a, std::uint32_t b) const {
        return std::ranges::any_of(at(a), [&](std::uint32_t t) { return has(t, b); });
    }

    // Calls visit(u) for the neighbours of a vertex: in a closed mesh each begins one edge opposite of it.
    template <class Visit>
    void for_each_neighbour(std::uint32_t v, const Visit& visit) const {
        for (const std::uint32_t t : at(v)) {
            const Triangle& corners = triangles_[t];
            const auto k = static_cast<std::size_t>(std::ranges::find(corners, v) - corners.begin());
            visit(corners[(k + 1) % 3]);
        }
    }

    // Returns whether v can be moved onto w.
    bool can_move(std::uint32_t v, std::uint32_t w) const {
        if (fan_[v].size + fan_[w].size - 4 > kMaxValence) return false;
        std::size_t common = 0;
        bool is_valid = true;
        for_each_neighbour(v, [&](std::uint32_t u) {
            if (u == w) return;
            if (are_joined(u, w)) {
                ++common;
                is_valid &= fan_[u].size > kMinValence;
            } else {
                const float unit = spacing(u, w);
                is_valid &= unit == 0 || distance(x_[u], x_[w]) <= kLong * unit;
            }
        });
        if (!is_valid || common != 2) return false;
        for (const std::uint32_t t : at(v)) {
            if (has(t, w)) continue;
            Triangle after = triangles_[t];
            std::ranges::replace(after, v, w);
            if (!faces_outward(after) || quality(points(after)) < kMinQuality) return false;
        }
        return true;
    }

    std::array<Vec3, 3> points(const Triangle& t) const { return {x_[t[0]], x_[t[1]], x_[t[2]]}; }

    bool faces_outward(const Triangle& t) const {
        const Vec3d n = area_normal(points(t));
        return std::ranges::all_of(t,
                                   [&](std::uint32_t v) { return dot(n, Vec3d(corners_[v].normal)) >= 0; });
    }

    // Replaces the edge of a triangle that begins at a corner by the other diagonal, if that is better.
    bool flip(std::uint32_t t, std::size_t k) {
        const std::uint32_t a = triangles_[t][k], b = triangles_[t][(k + 1) % 3],
                            c = triangles_[t][(k + 2) % 3];
        std::uint32_t other = kNoIndex, d = kNoIndex;
        for (const std::uint32_t u : at(a)) {
            if (u == t || !has(u, b)) continue;
            other = u;
            for (const std::uint32_t v : triangles_[u]) {
                if (v != a && v != b) d = v;
            }
        }
        if (other == kNoIndex || are_joined(c, d) || fan_[a].size <= kMinValence + 1 ||
            fan_[b].size <= kMinValence + 1)
            return false;
        const Triangle first{c, d, b}, second{d, c, a};
        const double before = std::min(quality(points(triangles_[t])), quality(points(triangles_[other])));
        if (std::min(quality(points(first)), quality(points(second))) < before + kGain) return false;
        if (!faces_outward(first) || !faces_outward(second)) return false;
        // a - b becomes c - d: t keeps b, the other triangle a.
        remove(a, t);
        remove(b, other);
        triangles_[t] = first;
        triangles_[other] = second;
        append(d, t);
        append(c, other);
        return true;
    }

    void append(std::uint32_t v, std::uint32_t triangle) {
        const auto begin = static_cast<std::uint32_t>(members_.size());
        old_fan_.assign(at(v).begin(), at(v).end());
        members_.insert(members_.end(), old_fan_.begin(), old_fan_.end());
        members_.push_back(triangle);
        fan_[v] = {begin, fan_[v].size + 1};
    }

    void remove(std::uint32_t v, std::uint32_t triangle) {
        const auto begin = members_.begin() + fan_[v].begin, end = begin + fan_[v].size;
        const auto at = std::find(begin, end, triangle);
        std::copy(at + 1, end, at);
        --fan_[v].size;
    }

    // Moves v onto w; returns the first queue with new edges.
    std::size_t move(std::uint32_t v, std::uint32_t w) {
        const auto begin = static_cast<std::uint32_t>(members_.size());
        old_fan_.assign(at(v).begin(), at(v).end());
        for (const std::uint32_t t : old_fan_) {
            if (!has(t, w)) {
                std::ranges::replace(triangles_[t], v, w);
                members_.push_back(t);
                continue;
            }
            for (const std::uint32_t u : triangles_[t]) {
                if (u != v) remove(u, t);
            }
            triangles_[t] = {kNoIndex, kNoIndex, kNoIndex};
        }
        const std::size_t moved = members_.size();
        old_fan_.assign(at(w).begin(), at(w).end());
        members_.insert(members_.end(), old_fan_.begin(), old_fan_.end());
        fan_[v].size = 0;
        fan_[w] = {begin, static_cast<std::uint32_t>(members_.size()) - begin};
        std::size_t first = kQueues;
        for (std::size_t i = begin; i < moved; ++i) {
            for (const std::uint32_t u : triangles_[members_[i]]) {
                if (u != w) first = std::min(first, add(u, w));
            }
        }
        return first;
    }

    std::span<const Vec3> x_;
    std::span<Triangle> triangles_;  // of kNoIndex if removed
    std::span<const GridCorner> corners_;
    std::vector<Fan> fan_;                // per vertex: its triangles
    std::vector<std::uint32_t> members_;  // triangles of fans; those of merged vertices are appended
    std::vector<std::uint32_t> old_fan_;  // temporary
    std::array<std::vector<Edge>, kQueues> queue_;  // by length, the shortest first
};

}  // namespace

std::vector<std::uint32_t> coarsen_triangles(TriMesh& mesh, std::span<const GridCorner> corners) {
    Coarsening coarsening(mesh, corners);
    coarsening.collapse_edges();
    coarsening.flip_edges();
    std::vector<std::uint32_t> kept, place(mesh.positions.size(), kNoIndex);
    for (std::uint32_t v = 0; v < place.size(); ++v) {
        if (!coarsening.is_used(v)) continue;
        place[v] = static_cast<std::uint32_t>(kept.size());
        mesh.positions[kept.size()] = mesh.positions[v];
        kept.push_back(v);
    }
    mesh.positions.resize(kept.size());
    std::size_t count = 0;
    for (const Triangle& t : mesh.triangles) {
        if (t[0] != kNoIndex) mesh.triangles[count++] = {place[t[0]], place[t[1]], place[t[2]]};
    }
    mesh.triangles.resize(count);
    return kept;
}

}  // namespace coppice
