#include "coppice/remesh/quadrangulate.h"

#include <algorithm>
#include <array>
#include <limits>

#include "coppice/base/error.h"
#include "coppice/mesh/shape.h"

namespace coppice {
namespace {

constexpr std::uint32_t kNone = std::numeric_limits<std::uint32_t>::max();
constexpr double kWorstPair = 0.3;  // scaled Jacobian below which two triangles are better left alone
constexpr float kFlattest = 0.5f;   // cosine between the normals of two triangles that make a quad

// An undirected edge, and one of its triangles with the corner from which that runs through it.
struct HalfEdge {
    std::uint32_t low, high, triangle, corner;
    friend auto operator<=>(const HalfEdge&, const HalfEdge&) = default;
};

struct Pair {
    double quality;
    std::uint32_t first, second;  // triangles
    Quad quad;
    std::uint32_t edge;
};

std::vector<HalfEdge> half_edges(std::span<const Triangle> triangles) {
    std::vector<HalfEdge> out;
    out.reserve(3 * triangles.size());
    for (std::uint32_t t = 0; t < triangles.size(); ++t) {
        for (std::uint32_t k = 0; k < 3; ++k) {
            const std::uint32_t a = triangles[t][k], b = triangles[t][(k + 1) % 3];
            out.push_back({std::min(a, b), std::max(a, b), t, k});
        }
    }
    std::sort(out.begin(), out.end());
    return out;
}

Vec3 normal(const Triangle& t, std::span<const Vec3> x) {
    return normalized(cross(x[t[1]] - x[t[0]], x[t[2]] - x[t[0]]));
}

std::vector<Pair> good_pairs(std::span<const Triangle> triangles, std::span<const HalfEdge> edges,
                             std::span<const Vec3> x) {
    std::vector<Pair> pairs;
    for (std::uint32_t e = 0; e + 1 < edges.size(); ++e) {
        const HalfEdge &p = edges[e], &q = edges[e + 1];
        if (p.low != q.low || p.high != q.high) continue;
        const Triangle &s = triangles[p.triangle], &t = triangles[q.triangle];
        const Quad quad{s[p.corner], t[(q.corner + 2) % 3], s[(p.corner + 1) % 3], s[(p.corner + 2) % 3]};
        const double quality = scaled_jacobian(quad, x);
        if (quality < kWorstPair || dot(normal(s, x), normal(t, x)) < kFlattest) continue;
        pairs.push_back({quality, p.triangle, q.triangle, quad, e});
    }
    std::sort(pairs.begin(), pairs.end(), [](const Pair& a, const Pair& b) {
        return a.quality != b.quality ? a.quality > b.quality : a.edge < b.edge;
    });
    return pairs;
}

// Faces of three or four corners, cut into quads around a vertex in their middle.
class Cutter {
  public:
    Cutter(std::span<const EdgeMiddle> given, Buffer<Vec3>& positions) : positions_(positions) {
        for (const EdgeMiddle& g : given)
            middles_.push_back({std::min(g.a, g.b), std::max(g.a, g.b), g.middle});
        sort();
    }

    void prepare(std::span<const HalfEdge> edges) {
        const std::size_t known = middles_.size();
        for (std::size_t e = 0; e < edges.size(); ++e) {
            const HalfEdge& h = edges[e];
            if (e > 0 && edges[e - 1].low == h.low && edges[e - 1].high == h.high) continue;
            if (find(h.low, h.high, known) == kNone) middles_.push_back({h.low, h.high, kNone});
        }
        sort();
    }

    void cut(std::span<const std::uint32_t> face, std::uint32_t triangle) {
        const std::size_t n = face.size();
        Vec3 sum;
        for (const std::uint32_t v : face) sum += positions_[v];
        const std::uint32_t center = append(sum / static_cast<float>(n));
        std::array<std::uint32_t, 4> middle{};
        for (std::size_t k = 0; k < n; ++k) middle[k] = middle_of(face[k], face[(k + 1) % n]);
        for (std::size_t k = 0; k < n; ++k)
            patch_.quads.push_back({face[k], middle[k], center, middle[(k + n - 1) % n]});
        patch_.triangle.resize(patch_.quads.size(), triangle);
    }

    QuadPatch take() && { return std::move(patch_); }

  private:
    struct Middle {
        std::uint32_t low, high, vertex;
    };
    static bool before(const Middle& a, const Middle& b) {
        return a.low != b.low ? a.low < b.low : a.high < b.high;
    }
    void sort() { std::sort(middles_.begin(), middles_.end(), before); }
    std::uint32_t find(std::uint32_t low, std::uint32_t high, std::size_t among) const {
        const auto end = middles_.begin() + static_cast<std::ptrdiff_t>(among);
        const auto at = std::lower_bound(middles_.begin(), end, Middle{low, high, 0}, before);
        return at != end && at->low == low && at->high == high
                   ? static_cast<std::uint32_t>(at - middles_.begin())
                   : kNone;
    }
    std::uint32_t append(Vec3 p) {
        positions_.push_back(p);
        return static_cast<std::uint32_t>(positions_.size() - 1);
    }
    std::uint32_t middle_of(std::uint32_t a, std::uint32_t b) {
        const std::uint32_t i = find(std::min(a, b), std::max(a, b), middles_.size());
        COPPICE_ASSERT(i != kNone);
        if (middles_[i].vertex == kNone) middles_[i].vertex = append((positions_[a] + positions_[b]) * 0.5f);
        return middles_[i].vertex;
    }

    Buffer<Vec3>& positions_;
    std::vector<Middle> middles_;
    QuadPatch patch_;
};

}  // namespace

QuadPatch quadrangulate(std::span<const Triangle> triangles, std::span<const std::uint8_t> alone,
                        std::span<const EdgeMiddle> given, Buffer<Vec3>& positions) {
    const std::vector<HalfEdge> edges = half_edges(triangles);
    Cutter cutter(given, positions);
    cutter.prepare(edges);
    std::vector<bool> used(alone.begin(), alone.end());
    for (const Pair& pair : good_pairs(triangles, edges, positions)) {
        if (used[pair.first] || used[pair.second]) continue;
        used[pair.first] = used[pair.second] = true;
        cutter.cut(pair.quad, pair.first);
    }
    for (std::uint32_t t = 0; t < triangles.size(); ++t) {
        if (!used[t] || alone[t] != 0) cutter.cut(triangles[t], t);
    }
    return std::move(cutter).take();
}

}  // namespace coppice
