#pragma once

#include <array>
#include <cstdint>

#include "coppice/subdivision/cage_topology.h"

namespace coppice {

// Calls body.template operator()<N>() for N = 2^level, so that all loops over a patch have constant length.
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

// Where the vertices of the cage's n x n patches lie: see the header.
template <int N>
class PatchIndex {
  public:
    explicit PatchIndex(const CageTopology& cage)
        : cage_(cage), edges_(cage.vertex_count()), faces_(edges_ + cage.edge_count() * kEdge) {}

    static constexpr std::uint32_t kEdge = N - 1;              // vertices inside an edge
    static constexpr std::uint32_t kFace = (N - 1) * (N - 1);  // and inside a face

    std::uint32_t edge_begin(std::uint32_t e) const { return edges_ + e * kEdge; }
    std::uint32_t face_begin(std::uint32_t f) const { return faces_ + f * kFace; }

    // Point i (0 < i < N) of a half-edge, counted from its start.
    std::uint32_t on_side(std::uint32_t half, std::uint32_t i) const {
        const std::uint32_t side = cage_.side[half >> 2][half & 3];
        return edge_begin(side >> 1) + ((side & 1) != 0 ? N - 1 - i : i - 1);
    }
    // The neighbour of a half-edge's start along it, and the one across its quad.
    std::uint32_t along(std::uint32_t half) const {
        if constexpr (N == 1) return cage_.corner(CageTopology::next(half));
        return on_side(half, 1);
    }
    std::uint32_t across(std::uint32_t half) const {
        if constexpr (N == 1) {
            return cage_.quads[half >> 2][(half + 2) & 3];
        } else {
            constexpr std::array<std::uint32_t, 4> kCorner = {0, N - 2, kFace - 1, kFace - kEdge};
            return face_begin(half >> 2) + kCorner[half & 3];
        }
    }

    // The N + 1 points of the row next to a half-edge, inside its quad, from its start to its end.
    void row_beside(std::uint32_t half, std::array<std::uint32_t, N + 1>& row) const {
        const std::uint32_t f = half >> 2;
        if constexpr (N == 1) {
            row = {cage_.quads[f][(half + 3) & 3], cage_.quads[f][(half + 2) & 3]};
        } else {
            constexpr std::uint32_t kM = N - 1;
            constexpr std::array<std::uint32_t, 4> kFirst = {0, kM - 1, kM * kM - 1, kM * (kM - 1)};
            constexpr std::array<std::uint32_t, 4> kStep = {1, kM, 0u - 1u, 0u - kM};
            row[0] = on_side(CageTopology::prev(half), N - 1);
            std::uint32_t inside = face_begin(f) + kFirst[half & 3];
            for (int i = 1; i < N; ++i, inside += kStep[half & 3]) row[i] = inside;
            row[N] = on_side(CageTopology::next(half), 1);
        }
    }

    using Grid = std::array<std::array<std::uint32_t, N + 1>, N + 1>;  // [row][column]

    void grid(std::uint32_t f, Grid& g) const {
        const Quad& q = cage_.quads[f];
        g[0][0] = q[0];
        g[0][N] = q[1];
        g[N][N] = q[2];
        g[N][0] = q[3];
        if constexpr (N > 1) {
            const auto& side = cage_.side[f];
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
    const CageTopology& cage_;
    std::uint32_t edges_, faces_;
};

// One corner of a refined quad.
struct QuadCorner {
    std::uint32_t quad;
    std::uint32_t corner;
};

// What lies around single refined vertices, by closed forms: for the few places that are looked at one by
// one.
class PatchStars {
  public:
    PatchStars(const CageTopology& cage, int levels)
        : cage_(cage),
          n_(1u << levels),
          edges_(cage.vertex_count()),
          faces_(edges_ + cage.edge_count() * (n_ - 1)) {}

    // The cage quad that counts the vertex as its own (see PatchRefinement::owned_vertices); kNone without
    // quads.
    std::uint32_t owner(std::uint32_t vertex) const {
        if (vertex >= faces_) return (vertex - faces_) / ((n_ - 1) * (n_ - 1));
        if (vertex >= edges_) {
            const auto& pair = cage_.edge_half[(vertex - edges_) / (n_ - 1)];
            return (pair[0] < pair[1] ? pair[0] : pair[1]) >> 2;
        }
        const auto fan = cage_.fans[vertex];
        return fan.empty() ? CageTopology::kNone : fan[0] >> 2;
    }

    bool on_boundary(std::uint32_t vertex) const {
        if (cage_.closed() || vertex >= faces_) return false;
        if (vertex < edges_) return cage_.on_boundary[vertex] != 0;
        const auto& pair = cage_.edge_half[(vertex - edges_) / (n_ - 1)];
        return pair[0] == CageTopology::kNone || pair[1] == CageTopology::kNone;
    }

    // Calls visit(QuadCorner) for every corner of a refined quad that is the vertex.
    template <class Visit>
    void for_each_corner(std::uint32_t vertex, const Visit& visit) const {
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
            if (forward != CageTopology::kNone) visit_side(forward, along, visit);
            if (backward != CageTopology::kNone) visit_side(backward, n_ - along, visit);
        } else {
            for (const std::uint32_t half : cage_.fans[vertex]) visit(QuadCorner{beside(half, 0), half & 3});
        }
    }

  private:
    // The refined quad number k along a half-edge, inside the half-edge's cage quad.
    std::uint32_t beside(std::uint32_t half, std::uint32_t k) const {
        const std::uint32_t m = n_ - 1;
        const std::array<std::uint32_t, 4> first = {0, m, n_ * n_ - 1, n_ * m};
        const std::array<std::uint32_t, 4> step = {1, n_, 0u - 1u, 0u - n_};
        return (half >> 2) * n_ * n_ + first[half & 3] + k * step[half & 3];
    }
    template <class Visit>
    void visit_side(std::uint32_t half, std::uint32_t along, const Visit& visit) const {
        visit(QuadCorner{beside(half, along - 1), (half + 1) & 3});
        visit(QuadCorner{beside(half, along), half & 3});
    }

    const CageTopology& cage_;
    std::uint32_t n_, edges_, faces_;
};

}  // namespace coppice
