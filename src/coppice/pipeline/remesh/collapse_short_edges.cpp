#include "coppice/pipeline/remesh/collapse_short_edges_internal.h"

#include <algorithm>
#include <array>
#include <limits>
#include <numbers>
#include <utility>
#include <vector>

#include "coppice/base/id.h"

namespace coppice {
namespace {

constexpr float kShort = 4.0f / 5, kLong = 4.0f / 3;  // of the requested length
constexpr double kMinCosine = 0.7071;                 // between the normals of a triangle before and after
constexpr double kMinQuality = 0.3;
constexpr std::size_t kMinValence = 4, kMaxValence = 9;
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

class Collapse {
  public:
    Collapse(TriMesh& mesh, std::span<const float> edge)
        : x_(mesh.positions), triangles_(mesh.triangles), edge_(edge), fan_(mesh.positions.size()) {
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

    void run() {
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
        const double onto_b = rate(e.a, e.b), onto_a = rate(e.b, e.a);
        if (std::max(onto_a, onto_b) <= 0) return kQueues;
        return onto_b >= onto_a ? move(e.a, e.b) : move(e.b, e.a);
    }

    std::span<const std::uint32_t> at(std::uint32_t v) const {
        return std::span(members_).subspan(fan_[v].begin, fan_[v].size);
    }

    float requested(std::uint32_t a, std::uint32_t b) const { return std::min(edge_[a], edge_[b]); }

    // Queues an edge by its length; returns its queue.
    std::size_t add(std::uint32_t a, std::uint32_t b) {
        const float length = distance(x_[a], x_[b]), limit = kShort * requested(a, b);
        if (!(length < limit)) return kQueues;
        const auto q = std::min(static_cast<std::size_t>(length / limit * kQueues), kQueues - 1);
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

    // Returns the minimum quality of triangles after v is moved onto w; 0 if it must not be moved.
    double rate(std::uint32_t v, std::uint32_t w) const {
        if (fan_[v].size + fan_[w].size - 4 > kMaxValence) return 0;
        std::size_t common = 0;
        bool is_valid = true;
        for_each_neighbour(v, [&](std::uint32_t u) {
            if (u == w) return;
            if (are_joined(u, w)) {
                ++common;
                is_valid &= fan_[u].size > kMinValence;
            } else {
                is_valid &= distance(x_[u], x_[w]) <= kLong * requested(u, w);
            }
        });
        if (!is_valid || common != 2) return 0;
        double worst = std::numeric_limits<double>::infinity();
        for (const std::uint32_t t : at(v)) {
            if (has(t, w)) continue;
            std::array<Vec3, 3> before, after;
            for (std::size_t k = 0; k < 3; ++k) {
                before[k] = x_[triangles_[t][k]];
                after[k] = triangles_[t][k] == v ? x_[w] : before[k];
            }
            const Vec3d n = area_normal(before), m = area_normal(after);
            if (dot(n, m) < kMinCosine * length(n) * length(m)) return 0;
            worst = std::min(worst, quality(after));
        }
        return worst >= kMinQuality ? worst : 0;
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
    std::span<const float> edge_;
    std::vector<Fan> fan_;                // per vertex: its triangles
    std::vector<std::uint32_t> members_;  // triangles of fans; those of merged vertices are appended
    std::vector<std::uint32_t> old_fan_;  // temporary
    std::array<std::vector<Edge>, kQueues> queue_;  // by length, the shortest first
};

}  // namespace

std::vector<std::uint32_t> collapse_short_edges(TriMesh& mesh, std::span<const float> edge) {
    Collapse collapse(mesh, edge);
    collapse.run();
    std::vector<std::uint32_t> kept, place(mesh.positions.size(), kNoIndex);
    for (std::uint32_t v = 0; v < place.size(); ++v) {
        if (!collapse.is_used(v)) continue;
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
