#include "coppice/pipeline/remesh/quadrangulate_internal.h"

#include <algorithm>
#include <array>
#include <limits>

#include "coppice/base/id.h"
#include "coppice/mesh/half_edges.h"
#include "coppice/mesh/shape.h"

namespace coppice {
namespace {

constexpr double kWorstPair = 0.3;  // scaled Jacobian below which two triangles are not joined
constexpr float kFlattest = 0.2f;   // minimum cosine between the normals of two triangles that form a quad

// Returns another half-edge of the same edge, the last one if there are several; kNoIndex at the boundary.
std::uint32_t neighbour(const HalfEdges& edges, std::uint32_t half) {
    const auto halves = edges.halves(edges.edge(half));
    if (halves.size() == 1) return kNoIndex;
    return halves.back() != half ? halves.back() : halves[halves.size() - 2];
}

// Returns the corners of two triangles that share an edge, from the beginning of the half-edge of the first.
Quad joined(const HalfEdges& edges, std::uint32_t half, std::uint32_t other) {
    const auto opposite = [&](std::uint32_t h) { return edges.origin(previous_half_edge<3>(h)); };
    return {edges.origin(half), opposite(other), edges.target(half), opposite(half)};
}

Vec3 normal(const Triangle& t, std::span<const Vec3> x) {
    return normalized(cross(x[t[1]] - x[t[0]], x[t[2]] - x[t[0]]));
}

// Joins triangles in pairs.
class Pairing {
  public:
    Pairing(std::span<const Triangle> triangles, const HalfEdges& edges, std::span<const Vec3> x)
        : twin_(3 * triangles.size(), kNoIndex), half_(triangles.size(), kNoIndex), step_(triangles.size()) {
        for (std::uint32_t h = 0; h < twin_.size(); ++h) {
            const std::uint32_t g = neighbour(edges, h);
            if (g == kNoIndex || g < h) continue;
            const double quality = scaled_jacobian(joined(edges, h, g), x);
            if (quality < kWorstPair ||
                dot(normal(triangles[h / 3], x), normal(triangles[g / 3], x)) < kFlattest)
                continue;
            good_.push_back({quality, h});
            twin_[h] = g;
            twin_[g] = h;
        }
    }

    // Joins the best pairs first, and then as many of the others as possible.
    void run() {
        std::sort(good_.begin(), good_.end(), [](const Pair& a, const Pair& b) {
            return a.quality != b.quality ? a.quality > b.quality : a.half < b.half;
        });
        for (const Pair& p : good_) {
            if (is_single(p.half / 3) && is_single(twin_[p.half] / 3)) join(p.half);
        }
        for (std::uint32_t t = 0; t < half_.size(); ++t) {
            if (is_single(t)) join_by_path(t);
        }
    }

    // Per triangle: its half-edge across which it joins another, or kNoIndex.
    std::span<const std::uint32_t> halves() const { return half_; }

  private:
    struct Pair {
        double quality;
        std::uint32_t half;
    };
    // The half-edge across which a search left the triangle before, and the search.
    struct Step {
        std::uint32_t half = kNoIndex, search = kNoIndex;
    };

    bool is_single(std::uint32_t t) const { return half_[t] == kNoIndex; }

    void join(std::uint32_t half) {
        half_[half / 3] = half;
        half_[twin_[half] / 3] = twin_[half];
    }

    // Joins a triangle with the closest other single one: pairs in between exchange their triangles.
    void join_by_path(std::uint32_t start) {
        constexpr std::size_t kMaxVisited = 1000;
        queue_.assign(1, start);
        step_[start] = {kNoIndex, start};
        for (std::size_t i = 0; i < queue_.size() && i < kMaxVisited; ++i) {
            const std::uint32_t t = queue_[i];
            for (std::uint32_t h = 3 * t; h < 3 * t + 3; ++h) {
                if (twin_[h] == kNoIndex) continue;
                const std::uint32_t next = twin_[h] / 3;
                if (next == start) continue;
                if (is_single(next)) return exchange(h);
                const std::uint32_t beyond = twin_[half_[next]] / 3;
                if (beyond == t || step_[beyond].search == start || step_[next].search == start) continue;
                step_[beyond] = {h, start};
                queue_.push_back(beyond);
            }
        }
    }

    // Joins triangles along the path that ends with a half-edge, instead of the pairs there.
    void exchange(std::uint32_t half) {
        while (half != kNoIndex) {
            const std::uint32_t before = step_[half / 3].half;
            join(half);
            half = before;
        }
    }

    std::vector<std::uint32_t> twin_;  // per half-edge: that of the other triangle, if they form a good quad
    std::vector<std::uint32_t> half_;
    std::vector<Pair> good_;
    std::vector<Step> step_;            // per triangle
    std::vector<std::uint32_t> queue_;  // of the search
};

std::uint32_t append(Buffer<Vec3>& positions, Vec3 p) {
    positions.push_back(p);
    return static_cast<std::uint32_t>(positions.size() - 1);
}

// Cuts faces of three or four corners into quads around a vertex in their middle.
class Cutter {
  public:
    Cutter(const HalfEdges& edges, std::span<const EdgeMiddle> given, Buffer<Vec3>& positions)
        : edges_(edges), positions_(positions), middle_(edges.edge_count(), kNoIndex) {
        for (const EdgeMiddle& g : given) {
            const std::uint32_t edge = edges.find(g.a, g.b);
            if (edge != kNoIndex) middle_[edge] = g.middle;
        }
    }

    // Cuts a face given by its half-edges.
    void cut(std::span<const std::uint32_t> halves) {
        const std::size_t n = halves.size();
        std::array<std::uint32_t, 4> corner{}, middle{};
        Vec3 sum;
        for (std::size_t k = 0; k < n; ++k) {
            corner[k] = edges_.origin(halves[k]);
            sum += positions_[corner[k]];
            middle[k] = compute_middle(halves[k]);
        }
        const std::uint32_t center = append(positions_, sum / static_cast<float>(n));
        for (std::size_t k = 0; k < n; ++k) {
            patch_.quads.push_back({corner[k], middle[k], center, middle[(k + n - 1) % n]});
            patch_.triangle.push_back(halves[k] / 3);
        }
    }

    QuadPatch take() && { return std::move(patch_); }

  private:
    std::uint32_t compute_middle(std::uint32_t half) {
        std::uint32_t& middle = middle_[edges_.edge(half)];
        if (middle == kNoIndex)
            middle = append(positions_,
                            (positions_[edges_.origin(half)] + positions_[edges_.target(half)]) * 0.5f);
        return middle;
    }

    const HalfEdges& edges_;
    Buffer<Vec3>& positions_;
    std::vector<std::uint32_t> middle_;  // per edge
    QuadPatch patch_;
};

}  // namespace

QuadPatch quadrangulate(std::span<const Triangle> triangles, std::span<const EdgeMiddle> given,
                        Buffer<Vec3>& positions) {
    const HalfEdges edges(triangles, static_cast<std::uint32_t>(positions.size()), {.threads = 1});
    Pairing pairing(triangles, edges, positions);
    pairing.run();
    const std::span<const std::uint32_t> pair = pairing.halves();
    Cutter cutter(edges, given, positions);
    for (std::uint32_t t = 0; t < triangles.size(); ++t) {
        if (pair[t] == kNoIndex) {
            cutter.cut(std::array{3 * t, 3 * t + 1, 3 * t + 2});
            continue;
        }
        const std::uint32_t h = pair[t], g = neighbour(edges, h);
        if (g / 3 < t) continue;
        cutter.cut(std::array{next_half_edge<3>(g), previous_half_edge<3>(g), next_half_edge<3>(h),
                              previous_half_edge<3>(h)});
    }
    return std::move(cutter).take();
}

void split_pairs(QuadPatch& patch, std::span<const std::uint8_t> alone, Buffer<Vec3>& positions) {
    QuadPatch out;
    const auto add = [&](Quad quad, std::uint32_t triangle) {
        out.quads.push_back(quad);
        out.triangle.push_back(triangle);
    };
    for (std::size_t q = 0; q < patch.quads.size();) {
        std::size_t end = q + 1;
        while (end < patch.quads.size() && patch.quads[end][2] == patch.quads[q][2]) ++end;
        const bool is_pair = end - q == 4;
        if (is_pair && (alone[patch.triangle[q]] != 0 || alone[patch.triangle[q + 2]] != 0)) {
            std::array<std::uint32_t, 4> corner{}, middle{};
            for (std::size_t k = 0; k < 4; ++k) {
                corner[k] = patch.quads[q + k][0];
                middle[k] = patch.quads[q + k][1];
            }
            // Corners 0 and 2 are those of the edge that both triangles share.
            const std::uint32_t first = patch.triangle[q], second = patch.triangle[q + 2];
            const Vec3 ends = positions[corner[0]] + positions[corner[2]];
            const std::uint32_t across = append(positions, ends * 0.5f);
            const std::uint32_t center = patch.quads[q][2];
            const std::uint32_t other = append(positions, (ends + positions[corner[3]]) / 3.0f);
            positions[center] = (ends + positions[corner[1]]) / 3.0f;
            add({corner[0], middle[0], center, across}, first);
            add({corner[1], middle[1], center, middle[0]}, first);
            add({corner[2], across, center, middle[1]}, first);
            add({corner[2], middle[2], other, across}, second);
            add({corner[3], middle[3], other, middle[2]}, second);
            add({corner[0], across, other, middle[3]}, second);
        } else {
            for (std::size_t k = q; k < end; ++k) add(patch.quads[k], patch.triangle[k]);
        }
        q = end;
    }
    patch = std::move(out);
}

}  // namespace coppice
