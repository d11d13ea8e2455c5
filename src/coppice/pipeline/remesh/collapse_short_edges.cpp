#include "coppice/pipeline/remesh/collapse_short_edges_internal.h"

#include <algorithm>
#include <array>
#include <limits>
#include <numbers>
#include <queue>

#include "coppice/base/id.h"

namespace coppice {
namespace {

constexpr float kShort = 4.0f / 5, kLong = 4.0f / 3;  // of the requested length
constexpr double kMinCosine = 0.7071;                 // between the normals of a triangle before and after
constexpr double kMinQuality = 0.3;
constexpr std::size_t kMinValence = 4, kMaxValence = 9;

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
        : x_(mesh.positions), triangles_(mesh.triangles), edge_(edge), at_(mesh.positions.size()) {
        for (std::uint32_t t = 0; t < triangles_.size(); ++t) {
            for (const std::uint32_t v : triangles_[t]) at_[v].push_back(t);
        }
        for (const Triangle& t : triangles_) {
            for (std::size_t k = 0; k < 3; ++k) {
                if (t[k] < t[(k + 1) % 3]) add(t[k], t[(k + 1) % 3]);
            }
        }
    }

    void run() {
        while (!queue_.empty()) {
            const Edge e = queue_.top();
            queue_.pop();
            if (at_[e.a].empty() || at_[e.b].empty() || !are_joined(e.a, e.b)) continue;
            const double onto_b = rate(e.a, e.b), onto_a = rate(e.b, e.a);
            if (std::max(onto_a, onto_b) <= 0) continue;
            if (onto_b >= onto_a) {
                move(e.a, e.b);
            } else {
                move(e.b, e.a);
            }
        }
    }

    bool is_used(std::uint32_t v) const { return !at_[v].empty(); }

  private:
    struct Edge {
        float ratio;  // length over the requested one
        std::uint32_t a, b;
        bool operator<(const Edge& o) const {  // the shortest is on top
            if (ratio != o.ratio) return ratio > o.ratio;
            return a != o.a ? a > o.a : b > o.b;
        }
    };

    float requested(std::uint32_t a, std::uint32_t b) const { return std::min(edge_[a], edge_[b]); }

    void add(std::uint32_t a, std::uint32_t b) {
        const float length = distance(x_[a], x_[b]), wanted = requested(a, b);
        if (length < kShort * wanted) queue_.push({length / wanted, std::min(a, b), std::max(a, b)});
    }

    bool has(std::uint32_t t, std::uint32_t v) const {
        return std::ranges::find(triangles_[t], v) != triangles_[t].end();
    }

    bool are_joined(std::uint32_t a, std::uint32_t b) const {
        return std::ranges::any_of(at_[a], [&](std::uint32_t t) { return has(t, b); });
    }

    // Calls visit(u) for the neighbours of a vertex: in a closed mesh each begins one edge opposite of it.
    template <class Visit>
    void for_each_neighbour(std::uint32_t v, const Visit& visit) const {
        for (const std::uint32_t t : at_[v]) {
            const Triangle& corners = triangles_[t];
            const auto k = static_cast<std::size_t>(std::ranges::find(corners, v) - corners.begin());
            visit(corners[(k + 1) % 3]);
        }
    }

    // Returns the minimum quality of triangles after v is moved onto w; 0 if it must not be moved.
    double rate(std::uint32_t v, std::uint32_t w) const {
        if (at_[v].size() + at_[w].size() - 4 > kMaxValence) return 0;
        std::size_t common = 0;
        bool is_valid = true;
        for_each_neighbour(v, [&](std::uint32_t u) {
            if (u == w) return;
            if (are_joined(u, w)) {
                ++common;
                is_valid &= at_[u].size() > kMinValence;
            } else {
                is_valid &= distance(x_[u], x_[w]) <= kLong * requested(u, w);
            }
        });
        if (!is_valid || common != 2) return 0;
        double worst = std::numeric_limits<double>::infinity();
        for (const std::uint32_t t : at_[v]) {
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

    void move(std::uint32_t v, std::uint32_t w) {
        std::vector<std::uint32_t> moved;
        for (const std::uint32_t t : at_[v]) {
            if (has(t, w)) {
                for (const std::uint32_t u : triangles_[t]) {
                    if (u != v) std::erase(at_[u], t);
                }
                triangles_[t] = {kNoIndex, kNoIndex, kNoIndex};
            } else {
                std::ranges::replace(triangles_[t], v, w);
                moved.push_back(t);
            }
        }
        at_[v].clear();
        at_[w].insert(at_[w].end(), moved.begin(), moved.end());
        for (const std::uint32_t t : moved) {
            for (const std::uint32_t u : triangles_[t]) {
                if (u != w) add(u, w);
            }
        }
    }

    std::span<const Vec3> x_;
    std::span<Triangle> triangles_;  // of kNoIndex if removed
    std::span<const float> edge_;
    std::vector<std::vector<std::uint32_t>> at_;  // per vertex: its triangles
    std::priority_queue<Edge> queue_;
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
