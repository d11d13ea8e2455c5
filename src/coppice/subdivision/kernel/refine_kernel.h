#pragma once

#include <array>
#include <cstdint>
#include <span>

#include "coppice/base/id.h"
#include "coppice/base/vec.h"
#include "coppice/subdivision/kernel/patch_index.h"

namespace coppice {

/// The two rules of the cubic B-spline. @{
template <class T>
COPPICE_HOST_DEVICE T between(const T& a, const T& b) {
    return 0.5f * (a + b);
}
template <class T>
COPPICE_HOST_DEVICE T adjacent(const T& a, const T& b, const T& c) {
    return 0.125f * (a + c) + 0.75f * b;
}
/// @}

/// Refines N + 1 points of a curve to the 2 N - 1 points strictly between its ends.
template <int N>
COPPICE_HOST_DEVICE void refine_curve(const Vec3* points, Vec3* out) {
    out[0] = between(points[0], points[1]);
    for (int i = 1; i < N; ++i) {
        out[2 * i - 1] = adjacent(points[i - 1], points[i], points[i + 1]);
        out[2 * i] = between(points[i], points[i + 1]);
    }
}

/// Computes the refined points inside a cage quad, row by row. Fast if each thread has its own cache.
template <int N>
void refine_face(const PatchIndex<N>& index, std::uint32_t f, std::span<const Vec3> in, Vec3* out) {
    constexpr int kWidth = 2 * N - 1;
    typename PatchIndex<N>::Grid grid;
    index.grid(f, grid);
    std::array<std::array<Vec3, kWidth>, N + 1> rows;
    for (int j = 0; j <= N; ++j) {
        std::array<Vec3, N + 1> row;
        for (int i = 0; i <= N; ++i) row[i] = in[grid[j][i]];
        refine_curve<N>(row.data(), rows[j].data());
    }
    for (int j = 0; j < N; ++j) {
        if (j > 0) {
            for (int i = 0; i < kWidth; ++i) *out++ = adjacent(rows[j - 1][i], rows[j][i], rows[j + 1][i]);
        }
        for (int i = 0; i < kWidth; ++i) *out++ = between(rows[j][i], rows[j + 1][i]);
    }
}

/// Computes the one in column i and row j, both in [1, 2 N - 1]. Fast if every point has a thread.
template <int N>
COPPICE_HOST_DEVICE Vec3 refine_face_point(const PatchIndex<N>& index, std::uint32_t f, std::uint32_t i,
                                           std::uint32_t j, std::span<const Vec3> in) {
    const auto row = [&](std::uint32_t r) {
        const auto at = [&](std::uint32_t c) { return in[index.at(f, c, r)]; };
        const std::uint32_t c = i / 2;
        return i % 2 == 1 ? between(at(c), at(c + 1)) : adjacent(at(c - 1), at(c), at(c + 1));
    };
    const std::uint32_t r = j / 2;
    return j % 2 == 1 ? between(row(r), row(r + 1)) : adjacent(row(r - 1), row(r), row(r + 1));
}

/// Computes the refined points inside a cage edge.
template <int N>
COPPICE_HOST_DEVICE void refine_edge(const CageView& cage, const PatchIndex<N>& index, std::uint32_t e,
                                     std::span<const Vec3> in, Vec3* out) {
    const auto [forward, backward] = cage.edge_half[e];
    const bool has_forward = forward != kNoIndex;
    std::array<Vec3, N + 1> curve;
    curve[0] = in[has_forward ? cage.corner(forward) : cage.corner(next_half_edge<4>(backward))];
    curve[N] = in[has_forward ? cage.corner(next_half_edge<4>(forward)) : cage.corner(backward)];
    for (int i = 1; i < N; ++i) curve[i] = in[index.edge_begin(e) + static_cast<std::uint32_t>(i - 1)];
    if (has_forward && backward != kNoIndex) {
        std::array<std::uint32_t, N + 1> left;
        std::array<std::uint32_t, N + 1> right;
        index.adjacent_row(forward, left);
        index.adjacent_row(backward, right);
        for (int i = 0; i <= N; ++i) curve[i] = adjacent(in[left[i]], curve[i], in[right[N - i]]);
    }
    refine_curve<N>(curve.data(), out);
}

/// Computes a cage vertex on a boundary: neighbours along the boundary only. Where several boundaries meet in
/// a vertex, all have the same weight.
template <int N>
COPPICE_HOST_DEVICE Vec3 refine_boundary_vertex(const CageView& cage, const PatchIndex<N>& index,
                                                std::uint32_t v, std::span<const Vec3> in) {
    const auto is_boundary = [&](std::uint32_t half) {
        const auto& pair = cage.pair(half);
        return pair[0] == kNoIndex || pair[1] == kNoIndex;
    };
    Vec3 sum;
    float count = 0;
    for (const std::uint32_t half : cage.fan(v)) {
        const std::uint32_t before = previous_half_edge<4>(half);
        if (is_boundary(half)) {
            sum += in[index.along(half)];
            count += 1;
        }
        if (is_boundary(before)) {
            sum += in[N == 1 ? cage.corner(before) : index.on_side(before, N - 1)];
            count += 1;
        }
    }
    return 0.75f * in[v] + sum * (0.25f / count);
}

/// Computes a cage vertex after one step.
template <int N>
COPPICE_HOST_DEVICE Vec3 refine_vertex(const CageView& cage, const PatchIndex<N>& index, std::uint32_t v,
                                       std::span<const Vec3> in) {
    const auto fan = cage.fan(v);
    if (fan.empty()) return in[v];
    if (!cage.closed() && cage.on_boundary[v] != 0) return refine_boundary_vertex<N>(cage, index, v, in);
    Vec3 along;
    Vec3 across;
    for (const std::uint32_t half : fan) {
        along += in[index.along(half)];
        across += in[index.across(half)];
    }
    const float per_valence = 1.0f / static_cast<float>(fan.size());
    return (1 - 1.75f * per_valence) * in[v] + per_valence * per_valence * (1.5f * along + 0.25f * across);
}

}  // namespace coppice
