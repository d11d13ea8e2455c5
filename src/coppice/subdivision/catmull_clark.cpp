#include "coppice/subdivision/catmull_clark.h"

#include <fmt/format.h>

#include <array>
#include <cstddef>

#include "coppice/base/error.h"
#include "coppice/base/parallel.h"
#include "coppice/subdivision/patch_index_internal.h"

namespace coppice {
namespace {

constexpr std::uint32_t kNone = CageTopology::kNone;
constexpr std::uint64_t kMaxCount = std::uint64_t{1} << 31;
constexpr std::size_t kPointsPerRange = 32768;

// The cubic B-spline's two rules.
template <class T>
T between(const T& a, const T& b) {
    return 0.5f * (a + b);
}
template <class T>
T beside(const T& a, const T& b, const T& c) {
    return 0.125f * (a + c) + 0.75f * b;
}

// N + 1 points of a curve to the 2 N - 1 refined ones strictly between its ends.
template <int N>
void refine_curve(const Vec3* points, Vec3* out) {
    out[0] = between(points[0], points[1]);
    for (int i = 1; i < N; ++i) {
        out[2 * i - 1] = beside(points[i - 1], points[i], points[i + 1]);
        out[2 * i] = between(points[i], points[i + 1]);
    }
}

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
            for (int i = 0; i < kWidth; ++i) *out++ = beside(rows[j - 1][i], rows[j][i], rows[j + 1][i]);
        }
        for (int i = 0; i < kWidth; ++i) *out++ = between(rows[j][i], rows[j + 1][i]);
    }
}

template <int N>
void refine_edge(const CageTopology& cage, const PatchIndex<N>& index, std::uint32_t e,
                 std::span<const Vec3> in, Vec3* out) {
    const auto [forward, backward] = cage.edge_half[e];
    const bool has_forward = forward != kNone;
    std::array<Vec3, N + 1> curve;
    curve[0] = in[has_forward ? cage.corner(forward) : cage.corner(CageTopology::next(backward))];
    curve[N] = in[has_forward ? cage.corner(CageTopology::next(forward)) : cage.corner(backward)];
    for (int i = 1; i < N; ++i) curve[i] = in[index.edge_begin(e) + static_cast<std::uint32_t>(i - 1)];
    if (has_forward && backward != kNone) {
        std::array<std::uint32_t, N + 1> left;
        std::array<std::uint32_t, N + 1> right;
        index.row_beside(forward, left);
        index.row_beside(backward, right);
        for (int i = 0; i <= N; ++i) curve[i] = beside(in[left[i]], curve[i], in[right[N - i]]);
    }
    refine_curve<N>(curve.data(), out);
}

// Neighbours along the boundary only. Where several boundaries meet in a vertex, all count alike.
template <int N>
Vec3 refine_boundary_vertex(const CageTopology& cage, const PatchIndex<N>& index, std::uint32_t v,
                            std::span<const Vec3> in) {
    const auto is_boundary = [&](std::uint32_t half) {
        const auto& pair = cage.edge_half[cage.side[half >> 2][half & 3] >> 1];
        return pair[0] == kNone || pair[1] == kNone;
    };
    Vec3 sum;
    float count = 0;
    for (const std::uint32_t half : cage.fans[v]) {
        const std::uint32_t before = CageTopology::prev(half);
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

template <int N>
Vec3 refine_vertex(const CageTopology& cage, const PatchIndex<N>& index, std::uint32_t v,
                   std::span<const Vec3> in) {
    const auto fan = cage.fans[v];
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

// One Catmull-Clark step from patches of N x N quads: three loops that only read `in` and write each output
// once.
template <int N>
void refine_level(const CageTopology& cage, std::span<const Vec3> in, std::span<Vec3> out,
                  const Context& ctx) {
    const PatchIndex<N> from(cage);
    const PatchIndex<2 * N> to(cage);
    const auto grain = [](std::size_t points_each) {
        return std::max<std::size_t>(1, kPointsPerRange / points_each);
    };
    parallel_for_ranges(ctx, cage.face_count(), grain(to.kFace), [&](IndexRange range) {
        for (std::size_t f = range.begin; f < range.end; ++f) {
            const auto face = static_cast<std::uint32_t>(f);
            refine_face<N>(from, face, in, &out[to.face_begin(face)]);
        }
    });
    parallel_for_ranges(ctx, cage.edge_count(), grain(8 * to.kEdge), [&](IndexRange range) {
        for (std::size_t e = range.begin; e < range.end; ++e) {
            const auto edge = static_cast<std::uint32_t>(e);
            refine_edge<N>(cage, from, edge, in, &out[to.edge_begin(edge)]);
        }
    });
    parallel_for_ranges(ctx, cage.vertex_count(), grain(16), [&](IndexRange range) {
        for (std::size_t v = range.begin; v < range.end; ++v) {
            out[v] = refine_vertex<N>(cage, from, static_cast<std::uint32_t>(v), in);
        }
    });
}

template <int N>
void write_quads(const PatchIndex<N>& index, std::uint32_t f, Quad* out) {
    typename PatchIndex<N>::Grid g;
    index.grid(f, g);
    for (int j = 0; j < N; ++j) {
        for (int i = 0; i < N; ++i) *out++ = {g[j][i], g[j][i + 1], g[j + 1][i + 1], g[j + 1][i]};
    }
}

std::uint64_t refined_vertex_count(const CageTopology& cage, int level) {
    const std::uint64_t inside = (std::uint64_t{1} << level) - 1;
    return cage.vertex_count() + inside * cage.edge_count() + inside * inside * cage.face_count();
}

void check_size(std::uint64_t count, const char* what, int levels) {
    if (count <= kMaxCount) return;
    throw InvalidInput(
        fmt::format("{} levels of subdivision would make {} {}, use fewer levels to stay below {}", levels,
                    count, what, kMaxCount));
}

}  // namespace

PatchRefinement::PatchRefinement(std::span<const Quad> quads, std::uint32_t vertex_count, int levels,
                                 const Context& ctx)
    : levels_(levels) {
    if (levels < 0 || levels > kMaxLevels) {
        throw InvalidInput(fmt::format("levels is {}, but must lie in 0 to {}", levels, kMaxLevels));
    }
    check_size(std::uint64_t{quads.size()} << (2 * levels), "quads", levels);
    cage_ = build_cage_topology(quads, vertex_count, ctx);
    const std::uint64_t count = refined_vertex_count(cage_, levels);
    check_size(count, "vertices", levels);
    vertex_count_ = static_cast<std::uint32_t>(count);
}

Buffer<Quad> PatchRefinement::quads(const Context& ctx) const {
    Buffer<Quad> out(quad_count());
    with_grid_size(levels_, [&]<int N>() {
        const PatchIndex<N> index(cage_);
        const std::size_t grain = std::max<std::size_t>(1, kPointsPerRange / (N * N));
        parallel_for(ctx, cage_.face_count(), grain, [&](std::size_t f) {
            write_quads<N>(index, static_cast<std::uint32_t>(f), &out[f * N * N]);
        });
    });
    return out;
}

Buffer<Vec3> PatchRefinement::refine(std::span<const Vec3> cage_points, const Context& ctx) const {
    COPPICE_ASSERT(cage_points.size() == cage_.vertex_count());
    Buffer<Vec3> points(cage_points.begin(), cage_points.end());
    for (int level = 0; level < levels_; ++level) {
        ctx.throw_if_cancelled();
        Buffer<Vec3> finer(refined_vertex_count(cage_, level + 1));
        with_grid_size(level, [&]<int N>() {
            if constexpr (N < 1 << kMaxLevels) refine_level<N>(cage_, points, finer, ctx);
        });
        points = std::move(finer);
    }
    return points;
}

std::uint32_t PatchRefinement::owned_vertices(std::uint32_t cage_quad, std::span<std::uint32_t> out) const {
    COPPICE_ASSERT(out.size() >= max_owned());
    std::uint32_t count = 0;
    with_grid_size(levels_, [&]<int N>() {
        const PatchIndex<N> index(cage_);
        for (std::uint32_t i = 0; i < index.kFace; ++i) out[count++] = index.face_begin(cage_quad) + i;
        for (std::uint32_t half = 4 * cage_quad; half < 4 * cage_quad + 4; ++half) {
            if (cage_.owns_vertex(half)) out[count++] = cage_.corner(half);
            if (index.kEdge == 0 || !cage_.owns_edge(half)) continue;
            for (std::uint32_t i = 1; i < N; ++i) out[count++] = index.on_side(half, i);
        }
    });
    return count;
}

Buffer<std::uint32_t> PatchRefinement::owners() const {
    const PatchStars stars(cage_, levels_);
    Buffer<std::uint32_t> out(vertex_count_);
    for (std::uint32_t v = 0; v < vertex_count_; ++v) out[v] = stars.owner(v);
    return out;
}

}  // namespace coppice
