#pragma once

#include <array>
#include <cstdint>

#include "coppice/base/id.h"
#include "coppice/subdivision/kernel/cage_view.h"

namespace coppice {

/// Calls the template body for N = 2^level, so that all loops over a patch have constant length.
template <class Body>
void with_grid_size(int level, const Body& body) {
    switch (level) {
        case 0:
            return body.template operator()<1>();
        case 1:
            return body.template operator()<2>();
        case 2:
            return body.template operator()<4>();
        case 3:
            return body.template operator()<8>();
        case 4:
            return body.template operator()<16>();
        case 5:
            return body.template operator()<32>();
        default:
            return body.template operator()<64>();
    }
}

/// Returns the vertex in column i and row j, both in [0, n], of the patch of n x n quads that refines a cage
/// quad.
COPPICE_HOST_DEVICE inline std::uint32_t patch_vertex(const CageView& cage, std::uint32_t n, std::uint32_t f,
                                                      std::uint32_t i, std::uint32_t j) {
    const bool left = i == 0, right = i == n, low = j == 0, high = j == n;
    if ((left || right) && (low || high)) return cage.quads[f][low ? (right ? 1 : 0) : (right ? 2 : 3)];
    const std::uint32_t edges = cage.vertex_count(), m = n - 1;
    if (left || right || low || high) {
        const std::uint32_t s = low ? 0 : right ? 1 : high ? 2 : 3;
        const std::uint32_t along = low ? i : right ? j : high ? n - i : n - j;
        const std::uint32_t side = cage.side[4 * f + s];
        return edges + (side >> 1) * m + ((side & 1) != 0 ? m - along : along - 1);
    }
    return edges + cage.edge_count() * m + f * m * m + (j - 1) * m + (i - 1);
}

/// Indices of the vertices of the cage's n x n patches: see PatchRefinement.
template <int N>
class PatchIndex {
  public:
    /// The cage must outlive this object.
    COPPICE_HOST_DEVICE explicit PatchIndex(const CageView& cage)
        : cage_(cage), edges_(cage.vertex_count()), faces_(edges_ + cage.edge_count() * kEdge) {}

    static constexpr std::uint32_t kEdge = N - 1;              ///< vertices inside an edge
    static constexpr std::uint32_t kFace = (N - 1) * (N - 1);  ///< vertices inside a face

    /// Returns the first vertex inside an edge.
    COPPICE_HOST_DEVICE std::uint32_t edge_begin(std::uint32_t e) const { return edges_ + e * kEdge; }
    /// Returns the first vertex inside a face.
    COPPICE_HOST_DEVICE std::uint32_t face_begin(std::uint32_t f) const { return faces_ + f * kFace; }

    /// Returns point i (0 < i < N) of a half-edge, counted from its beginning.
    COPPICE_HOST_DEVICE std::uint32_t on_side(std::uint32_t half, std::uint32_t i) const {
        const std::uint32_t side = cage_.side[half];
        return edge_begin(side >> 1) + ((side & 1) != 0 ? N - 1 - i : i - 1);
    }
    /// Returns the neighbour of a half-edge's beginning along it.
    COPPICE_HOST_DEVICE std::uint32_t along(std::uint32_t half) const {
        if constexpr (N == 1) return cage_.corner(next_half_edge<4>(half));
        return on_side(half, 1);
    }
    /// Returns the neighbour of a half-edge's beginning across its quad.
    COPPICE_HOST_DEVICE std::uint32_t across(std::uint32_t half) const {
        if constexpr (N == 1) {
            return cage_.quads[half >> 2][(half + 2) & 3];
        } else {
            constexpr std::array<std::uint32_t, 4> kCorner = {0, N - 2, kFace - 1, kFace - kEdge};
            return face_begin(half >> 2) + kCorner[half & 3];
        }
    }

    /// Returns the N + 1 points of the row next to a half-edge, inside its quad, from its beginning to its
    /// end.
    COPPICE_HOST_DEVICE void adjacent_row(std::uint32_t half, std::array<std::uint32_t, N + 1>& row) const {
        const std::uint32_t f = half >> 2;
        if constexpr (N == 1) {
            row = {cage_.quads[f][(half + 3) & 3], cage_.quads[f][(half + 2) & 3]};
        } else {
            constexpr std::uint32_t kM = N - 1;
            constexpr std::array<std::uint32_t, 4> kFirst = {0, kM - 1, kM * kM - 1, kM * (kM - 1)};
            constexpr std::array<std::uint32_t, 4> kStep = {1, kM, 0u - 1u, 0u - kM};
            row[0] = on_side(previous_half_edge<4>(half), N - 1);
            std::uint32_t inside = face_begin(f) + kFirst[half & 3];
            for (int i = 1; i < N; ++i, inside += kStep[half & 3]) row[i] = inside;
            row[N] = on_side(next_half_edge<4>(half), 1);
        }
    }

    /// Returns the vertex in column i and row j of a cage quad's patch, both in [0, N].
    COPPICE_HOST_DEVICE std::uint32_t at(std::uint32_t f, std::uint32_t i, std::uint32_t j) const {
        return patch_vertex(cage_, N, f, i, j);
    }

    using Grid = std::array<std::array<std::uint32_t, N + 1>, N + 1>;  ///< [row][column]

    /// Returns all vertices of a patch.
    COPPICE_HOST_DEVICE void grid(std::uint32_t f, Grid& g) const {
        const Quad& q = cage_.quads[f];
        g[0][0] = q[0];
        g[0][N] = q[1];
        g[N][N] = q[2];
        g[N][0] = q[3];
        if constexpr (N > 1) {
            const auto side = cage_.side.subspan(4 * f, 4);
            const auto walk = [&](int s, const auto& put) {
                const std::uint32_t begin = edge_begin(side[s] >> 1);
                if ((side[s] & 1) != 0) {
                    for (int i = 1; i < N; ++i) put(i, begin + static_cast<std::uint32_t>(N - 1 - i));
                } else {
                    for (int i = 1; i < N; ++i) put(i, begin + static_cast<std::uint32_t>(i - 1));
                }
            };
            walk(0, [&](int i, std::uint32_t v) { g[0][i] = v; });
            walk(1, [&](int i, std::uint32_t v) { g[i][N] = v; });
            walk(2, [&](int i, std::uint32_t v) { g[N][N - i] = v; });
            walk(3, [&](int i, std::uint32_t v) { g[N - i][0] = v; });
            std::uint32_t inside = face_begin(f);
            for (int j = 1; j < N; ++j) {
                for (int i = 1; i < N; ++i) g[j][i] = inside++;
            }
        }
    }

  private:
    CageView cage_;
    std::uint32_t edges_, faces_;
};

/// One corner of a refined quad.
struct QuadCorner {
    std::uint32_t quad;    ///< index of the quad
    std::uint32_t corner;  ///< of the quad, in [0, 3]
};

/// The neighbourhoods of single refined vertices, by closed forms: for the few positions that are processed
/// individually.
class PatchStars {
  public:
    /// The cage must outlive this object.
    COPPICE_HOST_DEVICE PatchStars(const CageView& cage, int levels)
        : cage_(cage),
          n_(1u << levels),
          edges_(cage.vertex_count()),
          faces_(edges_ + cage.edge_count() * (n_ - 1)) {}

    /// Returns the number of refined vertices.
    COPPICE_HOST_DEVICE std::uint32_t vertex_count() const {
        return faces_ + cage_.face_count() * (n_ - 1) * (n_ - 1);
    }
    /// Returns the vertex in column i and row j of a cage quad's patch, both in [0, n].
    COPPICE_HOST_DEVICE std::uint32_t vertex(std::uint32_t f, std::uint32_t i, std::uint32_t j) const {
        return patch_vertex(cage_, n_, f, i, j);
    }
    /// Returns the number of refined quads.
    COPPICE_HOST_DEVICE std::uint32_t quad_count() const { return cage_.face_count() * n_ * n_; }

    /// Returns the vertices of a refined quad.
    COPPICE_HOST_DEVICE Quad quad(std::uint32_t q) const {
        const std::uint32_t f = q / (n_ * n_), inside = q % (n_ * n_), i = inside % n_, j = inside / n_;
        return {vertex(f, i, j), vertex(f, i + 1, j), vertex(f, i + 1, j + 1), vertex(f, i, j + 1)};
    }

    /// Returns the cage quad that owns the vertex (see PatchRefinement::owned_vertices); kNoIndex without
    /// quads.
    COPPICE_HOST_DEVICE std::uint32_t owner(std::uint32_t vertex) const {
        if (vertex >= faces_) return (vertex - faces_) / ((n_ - 1) * (n_ - 1));
        if (vertex >= edges_) {
            const auto& pair = cage_.edge_half[(vertex - edges_) / (n_ - 1)];
            return (pair[0] < pair[1] ? pair[0] : pair[1]) >> 2;
        }
        const auto fan = cage_.fan(vertex);
        return fan.empty() ? kNoIndex : fan[0] >> 2;
    }

    /// Returns whether an adjacent edge of the vertex has only one quad.
    COPPICE_HOST_DEVICE bool on_boundary(std::uint32_t vertex) const {
        if (cage_.closed() || vertex >= faces_) return false;
        if (vertex < edges_) return cage_.on_boundary[vertex] != 0;
        const auto& pair = cage_.edge_half[(vertex - edges_) / (n_ - 1)];
        return pair[0] == kNoIndex || pair[1] == kNoIndex;
    }

    /// Calls visit(QuadCorner) for every corner of a refined quad at the vertex.
    template <class Visit>
    COPPICE_HOST_DEVICE void for_each_corner(std::uint32_t vertex, const Visit& visit) const {
        if (vertex >= faces_) {
            const std::uint32_t inside = (vertex - faces_) % ((n_ - 1) * (n_ - 1));
            const std::uint32_t first = owner(vertex) * n_ * n_ + inside / (n_ - 1) * n_ + inside % (n_ - 1);
            visit(QuadCorner{first, 2});
            visit(QuadCorner{first + 1, 3});
            visit(QuadCorner{first + n_ + 1, 0});
            visit(QuadCorner{first + n_, 1});
        } else if (vertex >= edges_) {
            const std::uint32_t along = (vertex - edges_) % (n_ - 1) + 1;
            const auto [forward, backward] = cage_.edge_half[(vertex - edges_) / (n_ - 1)];
            if (forward != kNoIndex) visit_side(forward, along, visit);
            if (backward != kNoIndex) visit_side(backward, n_ - along, visit);
        } else {
            for (const std::uint32_t half : cage_.fan(vertex)) visit(QuadCorner{adjacent(half, 0), half & 3});
        }
    }

  private:
    /// Returns the refined quad with index k along a half-edge, inside the half-edge's cage quad.
    COPPICE_HOST_DEVICE std::uint32_t adjacent(std::uint32_t half, std::uint32_t k) const {
        const std::uint32_t m = n_ - 1;
        const std::array<std::uint32_t, 4> first = {0, m, n_ * n_ - 1, n_ * m};
        const std::array<std::uint32_t, 4> step = {1, n_, 0u - 1u, 0u - n_};
        return (half >> 2) * n_ * n_ + first[half & 3] + k * step[half & 3];
    }
    template <class Visit>
    COPPICE_HOST_DEVICE void visit_side(std::uint32_t half, std::uint32_t along, const Visit& visit) const {
        visit(QuadCorner{adjacent(half, along - 1), (half + 1) & 3});
        visit(QuadCorner{adjacent(half, along), half & 3});
    }

    CageView cage_;
    std::uint32_t n_, edges_, faces_;
};

}  // namespace coppice
