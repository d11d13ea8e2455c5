#include "coppice/subdivision/cage_topology.h"

#include <fmt/format.h>

#include <algorithm>
#include <vector>

#include "coppice/base/error.h"
#include "coppice/base/id.h"
#include "coppice/base/parallel.h"

namespace coppice {
namespace {

constexpr std::size_t kVertexGrain = 4096;
constexpr std::size_t kFaceGrain = 4096;
constexpr std::uint32_t kMaxFaces = 1u << 29;  // half-edges and 2 edge + direction fit 32 bits

bool bad_quad(const Quad& q, std::uint32_t vertex_count) {
    bool bad = q[0] == q[2] || q[1] == q[3];
    for (int k = 0; k < 4; ++k) bad |= q[k] >= vertex_count || q[k] == q[(k + 1) & 3];
    return bad;
}

void check_quads(std::span<const Quad> quads, std::uint32_t vertex_count, const Context& ctx) {
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

// Result of one range of lower vertices.
struct EdgeRun {
    std::vector<std::array<std::uint32_t, 2>> edges;
    std::array<std::uint32_t, 2> bad = {kNoIndex, kNoIndex};  // ends of the first edge that is not manifold
};

// A half-edge at vertex u with a higher other end, sorted by that end, outgoing before incoming.
std::uint64_t entry(std::uint32_t other, bool incoming, std::uint32_t half) {
    return std::uint64_t{other} << 32 | std::uint64_t{incoming} << 31 | half;
}
std::uint32_t other_end(std::uint64_t e) { return static_cast<std::uint32_t>(e >> 32); }
bool is_incoming(std::uint64_t e) { return (e >> 31 & 1) != 0; }
std::uint32_t half_of(std::uint64_t e) { return static_cast<std::uint32_t>(e & 0x7fffffffu); }

// Fans are short: insertion sort avoids the overhead of std::sort; hubs use std::sort.
void sort_entries(std::span<std::uint64_t> entries) {
    if (entries.size() > 32) return std::sort(entries.begin(), entries.end());
    for (std::size_t i = 1; i < entries.size(); ++i) {
        const std::uint64_t e = entries[i];
        std::size_t j = i;
        for (; j > 0 && entries[j - 1] > e; --j) entries[j] = entries[j - 1];
        entries[j] = e;
    }
}

void pair_half_edges(std::span<const std::uint64_t> entries, std::uint32_t u, EdgeRun& run) {
    for (std::size_t i = 0; i < entries.size();) {
        const std::uint32_t other = other_end(entries[i]);
        std::size_t end = i + 1;
        while (end < entries.size() && other_end(entries[end]) == other) ++end;
        const bool manifold =
            end - i == 1 || (end - i == 2 && !is_incoming(entries[i]) && is_incoming(entries[i + 1]));
        if (!manifold && run.bad[0] == kNoIndex) run.bad = {u, other};
        std::array<std::uint32_t, 2> pair{kNoIndex, kNoIndex};
        for (std::size_t k = i; k < end; ++k) pair[is_incoming(entries[k])] = half_of(entries[k]);
        run.edges.push_back(pair);
        i = end;
    }
}

EdgeRun edges_of_vertices(const CageTopology& t, IndexRange vertices) {
    EdgeRun run;
    run.edges.reserve((t.fans.first[vertices.end] - t.fans.first[vertices.begin]) / 2 + 16);
    std::vector<std::uint64_t> entries;
    for (std::size_t v = vertices.begin; v < vertices.end; ++v) {
        const auto u = static_cast<std::uint32_t>(v);
        entries.clear();
        for (const std::uint32_t half : t.fans[v]) {
            const Quad& q = t.quads[half >> 2];
            const std::uint32_t to = q[(half + 1) & 3];
            const std::uint32_t from = q[(half + 3) & 3];
            if (to > u) entries.push_back(entry(to, false, half));
            if (from > u) entries.push_back(entry(from, true, CageTopology::prev(half)));
        }
        sort_entries(entries);
        pair_half_edges(entries, u, run);
    }
    return run;
}

void build_edges(CageTopology& t, const Context& ctx) {
    const std::size_t vertices = t.vertex_count();
    std::vector<EdgeRun> runs((vertices + kVertexGrain - 1) / kVertexGrain);
    parallel_for_ranges(ctx, vertices, kVertexGrain, [&](IndexRange range) {
        runs[range.begin / kVertexGrain] = edges_of_vertices(t, range);
    });
    std::vector<std::uint32_t> first(runs.size());
    for (std::size_t r = 0; r < runs.size(); ++r) {
        if (const auto& bad = runs[r].bad; bad[0] != kNoIndex) {
            throw InvalidInput(
                fmt::format("edge {}-{} of the cage must have one face, or two faces that run along it in "
                            "opposite directions",
                            bad[0], bad[1]));
        }
        first[r] = static_cast<std::uint32_t>(runs[r].edges.size());
    }
    t.edge_half.resize(exclusive_scan(std::span(first)));
    t.side.resize(t.quads.size());
    parallel_for(ctx, runs.size(), 1, [&](std::size_t r) {
        std::uint32_t e = first[r];
        for (const auto& pair : runs[r].edges) {
            for (std::uint32_t k = 0; k < 2; ++k) {
                if (pair[k] != kNoIndex) t.side[pair[k] >> 2][pair[k] & 3] = 2 * e + k;
            }
            t.edge_half[e++] = pair;
        }
    });
}

void mark_boundary(CageTopology& t) {
    for (const auto& pair : t.edge_half) {
        if (pair[0] != kNoIndex && pair[1] != kNoIndex) continue;
        if (t.on_boundary.empty()) t.on_boundary.assign(t.vertex_count(), std::uint8_t{0});
        const std::uint32_t half = std::min(pair[0], pair[1]);
        t.on_boundary[t.corner(half)] = 1;
        t.on_boundary[t.corner(CageTopology::next(half))] = 1;
    }
}

}  // namespace

CompressedRows<std::uint32_t> vertex_fans(std::span<const Quad> quads, std::uint32_t vertex_count) {
    return compress_rows<std::uint32_t>(vertex_count, [&](const auto& put) {
        std::uint32_t half = 0;
        for (const Quad& q : quads) {
            for (const std::uint32_t v : q) put(v, half++);
        }
    });
}

CageTopology build_cage_topology(std::span<const Quad> quads, std::uint32_t vertex_count,
                                 const Context& ctx) {
    if (quads.size() > kMaxFaces) {
        throw InvalidInput(
            fmt::format("a cage of {} quads is too large, use at most {}", quads.size(), kMaxFaces));
    }
    check_quads(quads, vertex_count, ctx);
    CageTopology t;
    t.quads.assign(quads.begin(), quads.end());
    t.fans = vertex_fans(quads, vertex_count);
    build_edges(t, ctx);
    mark_boundary(t);
    return t;
}

}  // namespace coppice
