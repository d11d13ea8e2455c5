#include "coppice/subdivision/catmull_clark.h"

#include <fmt/format.h>

#include <array>
#include <cstddef>

#include "coppice/base/error.h"
#include "coppice/base/parallel.h"
#include "coppice/subdivision/kernel/patch_index.h"
#include "coppice/subdivision/kernel/refine_kernel.h"

namespace coppice {
namespace {

constexpr std::uint64_t kMaxCount = std::uint64_t{1} << 31;
constexpr std::size_t kPointsPerRange = 32768;

// One Catmull-Clark step from patches of N x N quads: three loops that only read `in` and write each output
// once.
template <int N>
void refine_level(const CageView& cage, std::span<const Vec3> in, std::span<Vec3> out, const Context& ctx) {
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

void check_size(std::uint64_t count, const char* subject, int levels) {
    if (count <= kMaxCount) return;
    throw InvalidInput(
        fmt::format("{} levels of subdivision would create {} {}, use fewer levels to stay below {}", levels,
                    count, subject, kMaxCount));
}

}  // namespace

PatchRefinement::PatchRefinement(std::span<const Quad> quads, std::uint32_t vertex_count, int levels,
                                 const Context& ctx)
    : levels_(levels) {
    if (levels < 0 || levels > kMaxLevels) {
        throw InvalidInput(fmt::format("levels is {}, but must be from 0 to {}", levels, kMaxLevels));
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
