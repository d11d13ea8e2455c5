#include <algorithm>

#include "coppice/base/compressed_rows.h"
#include "coppice/base/id.h"
#include "coppice/base/parallel.h"
#include "coppice/extract/mesh/surface_internal.h"

namespace coppice::extract_internal {
namespace {

Vec3d area_normal(const Surface& s, std::uint32_t t) {
    const auto [a, b, c] = s.triangles[t];
    const Vec3d p(s.positions[a]);
    return cross(Vec3d(s.positions[b]) - p, Vec3d(s.positions[c]) - p);
}

/// Lists the half-edges that leave each vertex.
void list_outgoing(Surface& s) { s.out = group_by(all_corners(s.triangles), s.size()); }

/// Returns the two half-edges of a non-manifold edge that continue each other best: with opposite directions
/// and the most similar normals.
std::array<std::uint32_t, 2> best_pair(const Surface& s, std::span<const std::uint32_t> edges) {
    std::array<std::uint32_t, 2> best{edges[0], edges[1]};
    double best_score = -3;
    for (std::size_t i = 0; i < edges.size(); ++i) {
        for (std::size_t j = i + 1; j < edges.size(); ++j) {
            const double sign = s.from(edges[i]) == s.from(edges[j]) ? -1 : 1;
            const double score = sign * dot(normalized(area_normal(s, edges[i] / 3), {}),
                                            normalized(area_normal(s, edges[j] / 3), {}));
            if (score > best_score) {
                best_score = score;
                best = {edges[i], edges[j]};
            }
        }
    }
    return best;
}

SurfaceFindings pair_edges(Surface& s, const Context& ctx) {
    // with more half-edges the edge is degenerate: any pair is accepted
    constexpr std::size_t kMaxCompared = 16;
    SurfaceFindings found;
    s.twin.assign(3 * s.triangles.size(), kNoIndex);
    const HalfEdges edges(s.triangles, s.size(), ctx);
    for (std::uint32_t e = 0; e < edges.edge_count(); ++e) {
        const auto halves = edges.halves(e);
        if (halves.size() == 1) {
            ++found.open_edges;
            continue;
        }
        if (halves.size() > 2) ++found.non_manifold_edges;
        const auto few = halves.first(std::min(halves.size(), kMaxCompared));
        const auto [a, b] = halves.size() == 2 ? std::array{halves[0], halves[1]} : best_pair(s, few);
        s.twin[a] = b;
        s.twin[b] = a;
    }
    return found;
}

void find_components(Surface& s) {
    s.component.assign(s.size(), kNoIndex);
    s.component_count = 0;
    std::vector<std::uint32_t> stack;
    for (std::uint32_t seed = 0; seed < s.size(); ++seed) {
        if (s.component[seed] != kNoIndex) continue;
        s.component[seed] = s.component_count;
        stack.push_back(seed);
        while (!stack.empty()) {
            const std::uint32_t v = stack.back();
            stack.pop_back();
            for (const std::uint32_t h : s.outgoing(v)) {
                for (const std::uint32_t w : {s.to(h), s.from(previous_half_edge<3>(h))}) {
                    if (s.component[w] != kNoIndex) continue;
                    s.component[w] = s.component_count;
                    stack.push_back(w);
                }
            }
        }
        ++s.component_count;
    }
}

/// Reverses the orientation of triangle t and renumbers its half-edges.
void flip(Surface& s, std::uint32_t t) {
    std::swap(s.triangles[t][1], s.triangles[t][2]);
    // The corners a b c became a c b: edge ab is now the third, ca the first, bc remains the second.
    std::swap(s.twin[3 * t], s.twin[3 * t + 2]);
    for (std::uint32_t k : {0u, 2u}) {
        const std::uint32_t other = s.twin[3 * t + k];
        if (other != kNoIndex) s.twin[other] = 3 * t + k;
    }
}

}  // namespace

SurfaceFindings connect(Surface& surface, const Context& ctx) {
    list_outgoing(surface);
    const SurfaceFindings found = pair_edges(surface, ctx);
    find_components(surface);
    return found;
}

std::uint32_t orient(Surface& s) {
    std::uint32_t flipped = 0;
    std::vector<char> seen(s.triangles.size(), 0);
    std::vector<std::uint32_t> piece;
    for (std::uint32_t seed = 0; seed < s.triangles.size(); ++seed) {
        if (seen[seed]) continue;
        std::uint32_t flips = 0;
        piece.assign(1, seed);
        seen[seed] = 1;
        for (std::size_t i = 0; i < piece.size(); ++i) {
            for (std::uint32_t h = 3 * piece[i]; h < 3 * piece[i] + 3; ++h) {
                const std::uint32_t w = s.twin[h];
                if (w == kNoIndex || seen[w / 3]) continue;
                seen[w / 3] = 1;
                piece.push_back(w / 3);
                if (s.from(w) != s.from(h)) continue;
                flip(s, w / 3);
                ++flips;
            }
        }
        // The reference point is on the component, so that the sign of an open tube is that of its lateral
        // surface.
        const Vec3d origin(s.positions[s.triangles[seed][0]]);
        double volume = 0;
        for (const std::uint32_t t : piece)
            volume += dot(Vec3d(s.positions[s.triangles[t][0]]) - origin, area_normal(s, t));
        if (volume < 0) {
            for (const std::uint32_t t : piece) flip(s, t);
            flips = static_cast<std::uint32_t>(piece.size()) - flips;
        }
        flipped += flips;
    }
    if (flipped > 0) list_outgoing(s);
    return flipped;
}

std::vector<std::vector<std::uint32_t>> border_loops(const Surface& s) {
    std::vector<std::vector<std::uint32_t>> loops;
    std::vector<char> seen(s.size(), 0);
    const auto visit_border = [&](std::uint32_t v, const auto& visit) {
        for (const std::uint32_t h : s.outgoing(v)) {
            if (s.twin[h] == kNoIndex) visit(s.to(h));
            if (s.twin[previous_half_edge<3>(h)] == kNoIndex) visit(s.from(previous_half_edge<3>(h)));
        }
    };
    for (std::uint32_t v = 0; v < s.size(); ++v) {
        bool at_border = false;
        visit_border(v, [&](std::uint32_t) { at_border = true; });
        if (seen[v] || !at_border) continue;
        seen[v] = 1;
        loops.push_back({v});
        auto& loop = loops.back();
        for (std::size_t i = 0; i < loop.size(); ++i) {
            visit_border(loop[i], [&](std::uint32_t w) {
                if (seen[w]) return;
                seen[w] = 1;
                loop.push_back(w);
            });
        }
    }
    return loops;
}

std::vector<Vec3> vertex_normals(const Surface& s, const Context& ctx) {
    std::vector<Vec3> normals(s.size());
    parallel_for(ctx, s.size(), 4096, [&](std::size_t v) {
        Vec3d sum;
        for (const std::uint32_t h : s.outgoing(static_cast<std::uint32_t>(v))) sum += area_normal(s, h / 3);
        normals[v] = Vec3(normalized(sum, {}));
    });
    return normals;
}

}  // namespace coppice::extract_internal
