#include "coppice/subdivision/catmull_clark.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cstddef>

#include "coppice/base/error.h"
#include "coppice/base/parallel.h"
#include "coppice/subdivision/kernel/patch_index.h"
#include "coppice/subdivision/kernel/refine_kernel.h"

namespace coppice {
namespace {

constexpr std::uint64_t kMaxCount = std::uint64_t{1} << 31;
constexpr std::size_t kMaxFaces = std::size_t{1} << 29;  // half-edges and 2 edge + direction fit 32 bits
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

std::uint64_t refined_vertex_count(const CageView& cage, int level) {
    const std::uint64_t inside = (std::uint64_t{1} << level) - 1;
    return cage.vertex_count() + inside * cage.edge_count() + inside * inside * cage.face_count();
}

void check_size(std::uint64_t count, const char* subject, int levels) {
    if (count <= kMaxCount) return;
    throw InvalidInput(
        fmt::format("{} levels of subdivision would create {} {}, use fewer levels to stay below {}", levels,
                    count, subject, kMaxCount));
}

bool bad_quad(const Quad& q, std::uint32_t vertex_count) {
    bool bad = q[0] == q[2] || q[1] == q[3];
    for (int k = 0; k < 4; ++k) bad |= q[k] >= vertex_count || q[k] == q[(k + 1) & 3];
    return bad;
}

void check_quads(std::span<const Quad> quads, std::uint32_t vertex_count, const Context& ctx) {
    constexpr std::size_t kFaceGrain = 4096;
    const auto first_bad = parallel_reduce(
        ctx, quads.size(), kFaceGrain, quads.size(),
        [&](IndexRange range) {
            for (std::size_t f = range.begin; f < range.end; ++f) {
                if (bad_quad(quads[f], vertex_count)) return f;
            }
            return quads.size();
        },
        [](std::size_t a, std::size_t b) { return std::min(a, b); });
    if (first_bad == quads.size()) return;
    const Quad& q = quads[first_bad];
    throw InvalidInput(
        fmt::format("quad {} of the cage ({} {} {} {}) must name four different vertices below {}", first_bad,
                    q[0], q[1], q[2], q[3], vertex_count));
}

void check_edges(const HalfEdges& edges) {
    if (edges.irregular().empty()) return;
    const auto [low, high] = edges.ends(edges.edge(edges.irregular()[0]));
    throw InvalidInput(fmt::format(
        "edge {}-{} of the cage must have one face, or two faces that run along it in opposite directions",
        low, high));
}

/// Returns per vertex whether it is at a border edge; empty if there is none.
Buffer<std::uint8_t> boundary_vertices(const HalfEdges& edges) {
    Buffer<std::uint8_t> out;
    for (std::uint32_t h = 0; h < edges.size(); ++h) {
        if (edges.twin(h) != kNoIndex) continue;
        if (out.empty()) out.assign(edges.vertex_count(), std::uint8_t{0});
        out[edges.origin(h)] = out[edges.target(h)] = 1;
    }
    return out;
}

}  // namespace

PatchRefinement::PatchRefinement(std::span<const Quad> quads, std::uint32_t vertex_count, int levels,
                                 const Context& ctx)
    : levels_(levels) {
    if (levels < 0 || levels > kMaxLevels) {
        throw InvalidInput(fmt::format("levels is {}, but must be from 0 to {}", levels, kMaxLevels));
    }
    check_size(std::uint64_t{quads.size()} << (2 * levels), "quads", levels);
    if (quads.size() > kMaxFaces) {
        throw InvalidInput(
            fmt::format("a cage of {} quads is too large, use at most {}", quads.size(), kMaxFaces));
    }
    check_quads(quads, vertex_count, ctx);
    quads_.assign(quads.begin(), quads.end());
    const HalfEdges edges(quads, vertex_count, ctx);
    check_edges(edges);
    side_.assign(edges.sides().begin(), edges.sides().end());
    edge_half_.assign(edges.pairs().begin(), edges.pairs().end());
    fans_ = group_by(all_corners(quads), vertex_count);
    on_boundary_ = boundary_vertices(edges);
    const std::uint64_t count = refined_vertex_count(cage(), levels);
    check_size(count, "vertices", levels);
    vertex_count_ = static_cast<std::uint32_t>(count);
}

CageView PatchRefinement::cage() const {
    return {quads_, side_, edge_half_, fans_.first, fans_.items, on_boundary_};
}

Buffer<Quad> PatchRefinement::quads(const Context& ctx) const {
    Buffer<Quad> out(quad_count());
    with_grid_size(levels_, [&]<int N>() {
        const PatchIndex<N> index(cage());
        const std::size_t grain = std::max<std::size_t>(1, kPointsPerRange / (N * N));
        parallel_for(ctx, quads_.size(), grain, [&](std::size_t f) {
            write_quads<N>(index, static_cast<std::uint32_t>(f), &out[f * N * N]);
        });
    });
    return out;
}

Buffer<Vec3> PatchRefinement::refine(std::span<const Vec3> cage_points, const Context& ctx) const {
    const CageView cage = this->cage();
    COPPICE_ASSERT(cage_points.size() == cage.vertex_count());
    Buffer<Vec3> points(cage_points.begin(), cage_points.end());
    for (int level = 0; level < levels_; ++level) {
        ctx.throw_if_cancelled();
        Buffer<Vec3> finer(refined_vertex_count(cage, level + 1));
        with_grid_size(level, [&]<int N>() {
            if constexpr (N < 1 << kMaxLevels) refine_level<N>(cage, points, finer, ctx);
        });
        points = std::move(finer);
    }
    return points;
}

std::uint32_t PatchRefinement::owned_vertices(std::uint32_t cage_quad, std::span<std::uint32_t> out) const {
    COPPICE_ASSERT(out.size() >= max_owned());
    std::uint32_t count = 0;
    with_grid_size(levels_, [&]<int N>() {
        const CageView cage = this->cage();
        const PatchIndex<N> index(cage);
        for (std::uint32_t i = 0; i < index.kFace; ++i) out[count++] = index.face_begin(cage_quad) + i;
        for (std::uint32_t half = 4 * cage_quad; half < 4 * cage_quad + 4; ++half) {
            if (cage.owns_vertex(half)) out[count++] = cage.corner(half);
            if (index.kEdge == 0 || !cage.owns_edge(half)) continue;
            for (std::uint32_t i = 1; i < N; ++i) out[count++] = index.on_side(half, i);
        }
    });
    return count;
}

Buffer<std::uint32_t> PatchRefinement::owners() const {
    const PatchStars stars(cage(), levels_);
    Buffer<std::uint32_t> out(vertex_count_);
    for (std::uint32_t v = 0; v < vertex_count_; ++v) out[v] = stars.owner(v);
    return out;
}

}  // namespace coppice
