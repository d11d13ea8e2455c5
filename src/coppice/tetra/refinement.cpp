#include "coppice/tetra/refinement.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

#include "coppice/base/parallel.h"

namespace coppice {
namespace {

using Local = TetraPattern::Local;
using Kind = TetraRefinement::Kind;

constexpr std::size_t kGrain = 2048;                      // tetrahedra
constexpr std::uint32_t kFirstEdge = 4, kFirstFace = 10;  // groups
constexpr std::uint32_t kNone = std::numeric_limits<std::uint32_t>::max();

Kind kind_of(std::uint32_t group) { return static_cast<Kind>(TetraRefinement::kKindOf[group]); }

std::array<Vec3d, 4> corners_of(const TetraMesh& mesh, std::span<const std::uint32_t> vertices) {
    std::array<Vec3d, 4> p;
    for (std::size_t i = 0; i < 4; ++i) p[i] = Vec3d(mesh.positions[vertices[i]]);
    return p;
}

double determinant(const std::array<Vec3d, 4>& p) {
    return dot(cross(p[1] - p[0], p[2] - p[0]), p[3] - p[0]);
}

std::uint8_t shortest_diagonal(const std::array<Vec3d, 4>& p) {
    std::uint8_t best = 0;
    double best_length = std::numeric_limits<double>::infinity();
    for (std::uint8_t d = 0; d < std::uint8_t{kTetraDiagonals.size()}; ++d) {
        const auto& c = kTetraDiagonals[d];
        const double squared = length_squared((p[c[0]] + p[c[1]]) - (p[c[2]] + p[c[3]]));
        if (squared >= best_length) continue;
        best = d;
        best_length = squared;
    }
    return best;
}

struct Extent {
    double shortest_edge, width;
};

/// The least width of a tetrahedron is between two planes that hold a face and a vertex, or two opposite
/// edges: six times the volume over the length of a cross product of edges. With a path of edges x, y, z
/// through the corners, all these are sums of the products of two of x, y, z; and the descendants have the
/// same three edges in another order.
Extent extent(const std::array<Vec3d, 4>& p, std::uint8_t diagonal) {
    const auto& c = kTetraDiagonals[diagonal];
    const Vec3d x = p[c[2]] - p[c[0]], y = p[c[1]] - p[c[2]], z = p[c[3]] - p[c[1]];
    double shortest = std::numeric_limits<double>::infinity();
    for (const Vec3d e : {x, y, z, x + y, y + z, x + z, x + y + z})
        shortest = std::min(shortest, length_squared(e));
    const Vec3d xy = cross(x, y), yz = cross(y, z), xz = cross(x, z);
    double widest = 0;
    const auto add = [&](Vec3d first, Vec3d second, Vec3d ends) {
        for (const Vec3d n :
             {first, second, ends, first + ends, second + ends, second - first, first + ends + second})
            widest = std::max(widest, length_squared(n));
    };
    add(xy, yz, xz);   // path x, y, z
    add(xz, -yz, xy);  // x, z, y
    add(-xy, xz, yz);  // y, x, z
    return {std::sqrt(shortest), std::abs(dot(xy, z)) / std::sqrt(widest)};
}

/// An edge or a face as one tetrahedron sees it, seen from its least vertex.
struct Entry {
    std::uint64_t key;  ///< the other vertices
    std::uint32_t tetra;
    std::uint32_t group;  ///< there
    friend bool operator<(const Entry& a, const Entry& b) {
        return a.key != b.key ? a.key < b.key : a.tetra < b.tetra;
    }
};

/// Edges and faces whose least vertex is corner c of a tetrahedron.
template <class Visit>
void for_each_edge_above(std::uint32_t c, const Visit& visit) {
    for (std::uint32_t e = 0; e < 6; ++e) {
        if (kTetraEdges[e][0] == c) visit(kFirstEdge + e, kTetraEdges[e][1]);
    }
}
template <class Visit>
void for_each_face_above(std::uint32_t c, const Visit& visit) {
    if (c == 1) visit(kFirstFace + 0, 2u, 3u);
    if (c != 0) return;
    visit(kFirstFace + 1, 2u, 3u);
    visit(kFirstFace + 2, 1u, 3u);
    visit(kFirstFace + 3, 1u, 2u);
}

std::uint32_t corner_of(const TetraRefinement::Parts& parts, std::uint32_t vertex) {
    return static_cast<std::uint32_t>(std::find(parts.begin(), parts.begin() + 3, vertex) - parts.begin());
}

}  // namespace

TetraRefinement::TetraRefinement(const TetraMesh& coarse, int levels, const Context& ctx)
    : coarse_(coarse), levels_(levels) {
    if (levels < 0 || levels > TetraPattern::kMostLevels) {
        throw InvalidInput(fmt::format("tetra refinement: levels must lie between 0 and {}, but is {}",
                                       TetraPattern::kMostLevels, levels));
    }
    check(ctx);
    describe(ctx);
    find_vertex_stars();
    ctx.throw_if_cancelled();
    find_parts(ctx);
    find_hull_and_owners(ctx);

    const std::uint32_t n = 1u << levels;
    per_kind_ = {1, n - 1, (n - 1) * (n - 2) / 2, n < 4 ? 0 : (n - 1) * (n - 2) * (n - 3) / 6};
    const std::array<std::uint64_t, 4> parts{coarse.positions.size(), edge_count(), face_count(),
                                             coarse.tetra.size()};
    std::uint64_t total = 0;
    for (std::size_t k = 0; k < 4; ++k) {
        first_of_kind_[k] = static_cast<std::uint32_t>(total);
        total += parts[k] * per_kind_[k];
        if (total > kMostVertices) {
            throw InvalidInput(
                fmt::format("tetra refinement: levels = {} makes more than {} vertices of {} tetrahedra; "
                            "take fewer levels",
                            levels, kMostVertices, coarse.tetra.size()));
        }
    }
    vertex_count_ = static_cast<std::uint32_t>(total);
    for (std::uint32_t d = 0; d < 3; ++d) patterns_[d] = tetra_pattern(levels, d);
}

void TetraRefinement::check(const Context& ctx) const {
    const auto& tetra = coarse_.tetra;
    if (coarse_.positions.size() >= kNone / 4 || tetra.size() >= kNone / 8)
        throw InvalidInput("tetra refinement: more than 2^29 tetrahedra; make them larger");
    if (coarse_.first.empty() || coarse_.first.front() != 0 || coarse_.first.back() != tetra.size() ||
        !std::ranges::is_sorted(coarse_.first))
        throw InvalidInput("tetra refinement: the regions do not cover the tetrahedra one after the other");
    const auto bad = [&](const Tetra& t) {
        if (std::ranges::any_of(t, [&](std::uint32_t v) { return v >= coarse_.positions.size(); }))
            return true;
        const double d = determinant(corners_of(coarse_, t));
        return !(d > 0 && std::isfinite(d));
    };
    const auto first_bad = parallel_reduce(
        ctx, tetra.size(), kGrain, tetra.size(),
        [&](IndexRange r) {
            for (std::size_t t = r.begin; t < r.end; ++t) {
                if (bad(tetra[t])) return t;
            }
            return tetra.size();
        },
        [](std::size_t a, std::size_t b) { return std::min(a, b); });
    if (first_bad == tetra.size()) return;
    throw InvalidInput(
        fmt::format("tetra refinement: tetrahedron {} has a vertex that does not exist or no positive "
                    "volume; order its vertices",
                    first_bad));
}

void TetraRefinement::describe(const Context& ctx) {
    const std::size_t count = coarse_.tetra.size();
    parts_.resize(count);
    traits_.resize(count);
    parallel_for(ctx, count, kGrain, [&](std::size_t t) {
        Tetra sorted = coarse_.tetra[t];
        bool odd = false;
        for (std::size_t i = 0; i < 4; ++i) {
            for (std::size_t j = i + 1; j < 4; ++j) odd ^= sorted[i] > sorted[j];
        }
        std::ranges::sort(sorted);
        std::ranges::copy(sorted, parts_[t].begin());
        const auto corners = corners_of(coarse_, sorted);
        const std::uint8_t diagonal = shortest_diagonal(corners);
        const Extent e = extent(corners, diagonal);
        const double fine = 1.0 / (1 << levels_);
        traits_[t] = {static_cast<float>(e.shortest_edge * fine),
                      static_cast<float>(e.width * fine),
                      0,
                      0,
                      diagonal,
                      odd};
    });
}

void TetraRefinement::find_vertex_stars() {
    first_at_vertex_.assign(coarse_.positions.size() + 1, 0);
    for (const Tetra& t : coarse_.tetra) {
        for (const std::uint32_t v : t) ++first_at_vertex_[v];
    }
    exclusive_scan(std::span(first_at_vertex_));
    Buffer<std::uint32_t> next(first_at_vertex_);
    at_vertex_.resize(4 * coarse_.tetra.size());
    for (std::size_t t = 0; t < coarse_.tetra.size(); ++t) {
        for (const std::uint32_t v : coarse_.tetra[t]) at_vertex_[next[v]++] = static_cast<std::uint32_t>(t);
    }
}

/// Every vertex numbers the edges and faces of which it is the least vertex: the tetrahedra around it, sorted
/// by the other vertices, name each of them some times in a row.
void TetraRefinement::find_parts(const Context& ctx) {
    constexpr std::size_t kVertexGrain = 512;
    const std::size_t vertices = coarse_.positions.size();
    struct Found {
        std::vector<std::uint32_t> edge_sizes;  ///< of all edges of a range of vertices
        std::vector<std::uint32_t> at_edge;
        std::vector<FaceSides> faces;
        std::uint32_t crowded = kNone;
    };
    std::vector<Found> found((vertices + kVertexGrain - 1) / kVertexGrain);
    parallel_for_ranges(ctx, vertices, kVertexGrain, [&](IndexRange r) {
        Found& f = found[r.begin / kVertexGrain];
        std::vector<Entry> edges, faces;
        for (std::size_t v = r.begin; v < r.end; ++v) {
            edges.clear();
            faces.clear();
            for (const std::uint32_t t : around(Kind::vertex, static_cast<std::uint32_t>(v))) {
                const Parts& p = parts_[t];
                const std::uint32_t c = corner_of(p, static_cast<std::uint32_t>(v));
                for_each_edge_above(c, [&](std::uint32_t group, std::uint32_t b) {
                    edges.push_back({p[b], t, group});
                });
                for_each_face_above(c, [&](std::uint32_t group, std::uint32_t b, std::uint32_t d) {
                    faces.push_back({std::uint64_t{p[b]} << 32 | p[d], t, group});
                });
            }
            std::ranges::sort(edges, std::less<>());
            std::ranges::sort(faces, std::less<>());
            for (std::size_t i = 0; i < edges.size(); ++i) {
                if (i == 0 || edges[i].key != edges[i - 1].key) f.edge_sizes.push_back(0);
                ++f.edge_sizes.back();
                f.at_edge.push_back(edges[i].tetra);
                parts_[edges[i].tetra][edges[i].group] = static_cast<std::uint32_t>(f.edge_sizes.size() - 1);
            }
            for (std::size_t i = 0; i < faces.size(); ++i) {
                if (i == 0 || faces[i].key != faces[i - 1].key) f.faces.push_back({{kNone, kNone}, 0});
                FaceSides& sides = f.faces.back();
                if (sides.count < 2) {
                    sides.tetra[sides.count++] = faces[i].tetra;
                } else {
                    f.crowded = std::min(f.crowded, faces[i].tetra);
                }
                parts_[faces[i].tetra][faces[i].group] = static_cast<std::uint32_t>(f.faces.size() - 1);
            }
        }
    });

    std::vector<std::uint32_t> first_edge, first_entry, first_face;
    std::uint32_t crowded = kNone;
    for (const Found& f : found) {
        first_edge.push_back(static_cast<std::uint32_t>(f.edge_sizes.size()));
        first_entry.push_back(static_cast<std::uint32_t>(f.at_edge.size()));
        first_face.push_back(static_cast<std::uint32_t>(f.faces.size()));
        crowded = std::min(crowded, f.crowded);
    }
    if (crowded != kNone) {
        throw InvalidInput(fmt::format(
            "tetra refinement: tetrahedron {} has a face with more than one other; leave all but two out",
            crowded));
    }
    const std::uint32_t edges = exclusive_scan(std::span(first_edge));
    at_edge_.resize(exclusive_scan(std::span(first_entry)));
    at_face_.resize(exclusive_scan(std::span(first_face)));
    first_at_edge_.resize(edges + 1u);
    first_at_edge_[edges] = static_cast<std::uint32_t>(at_edge_.size());
    parallel_for(ctx, found.size(), 1, [&](std::size_t i) {
        const Found& f = found[i];
        std::ranges::copy(f.at_edge, at_edge_.begin() + first_entry[i]);
        std::ranges::copy(f.faces, at_face_.begin() + first_face[i]);
        std::uint32_t entry = first_entry[i];
        for (std::size_t e = 0; e < f.edge_sizes.size(); ++e) {
            first_at_edge_[first_edge[i] + e] = entry;
            entry += f.edge_sizes[e];
        }
    });
    parallel_for(ctx, parts_.size(), kGrain, [&](std::size_t t) {
        Parts& p = parts_[t];
        for (std::uint32_t e = 0; e < 6; ++e)
            p[kFirstEdge + e] += first_edge[p[kTetraEdges[e][0]] / kVertexGrain];
        for (std::uint32_t f = 0; f < 4; ++f)
            p[kFirstFace + f] += first_face[p[f == 0 ? 1 : 0] / kVertexGrain];
    });
}

void TetraRefinement::find_hull_and_owners(const Context& ctx) {
    std::vector<std::uint8_t> hull_vertex(coarse_.positions.size()), hull_edge(edge_count());
    for (std::uint32_t f = 0; f < face_count(); ++f) {
        if (at_face_[f].count != 1) continue;
        const std::uint32_t t = at_face_[f].tetra[0];
        const std::uint32_t opposite = group_in(t, Kind::face, f) - kFirstFace;
        for (std::uint32_t c = 0; c < 4; ++c) {
            if (c != opposite) hull_vertex[parts_[t][c]] = 1;
        }
        for (std::uint32_t e = 0; e < 6; ++e) {
            if (kTetraEdges[e][0] != opposite && kTetraEdges[e][1] != opposite)
                hull_edge[parts_[t][kFirstEdge + e]] = 1;
        }
    }
    parallel_for(ctx, parts_.size(), kGrain, [&](std::size_t i) {
        const auto t = static_cast<std::uint32_t>(i);
        std::uint32_t owned = 1u << TetraPattern::kInside, hull = 0;
        for (std::uint32_t g = 0; g < TetraPattern::kInside; ++g) {
            const std::uint32_t part = parts_[t][g];
            if (around(kind_of(g), part).front() == t) owned |= 1u << g;
            const bool on_hull = g < kFirstEdge   ? hull_vertex[part] != 0
                                 : g < kFirstFace ? hull_edge[part] != 0
                                                  : at_face_[part].count == 1;
            if (on_hull) hull |= 1u << g;
        }
        traits_[t].owned = static_cast<std::uint16_t>(owned);
        traits_[t].on_hull = static_cast<std::uint16_t>(hull);
    });
}

TetraRefinement::Place TetraRefinement::place(std::uint32_t vertex) const {
    std::size_t kind = 3;
    while (vertex < first_of_kind_[kind] || per_kind_[kind] == 0) --kind;
    const std::uint32_t offset = vertex - first_of_kind_[kind];
    return {static_cast<Kind>(kind), offset / per_kind_[kind], offset % per_kind_[kind]};
}

Vec3 TetraRefinement::position(std::uint32_t tetra, Local local) const {
    const auto& w = pattern(tetra).weights[local];
    const Parts& p = parts_[tetra];
    const float part = 1.0f / static_cast<float>(1 << levels_);
    Vec3 sum;
    // In ascending order of the corners; those without weight add nothing, not even an error.
    for (std::size_t i = 0; i < 4; ++i) sum += coarse_.positions[p[i]] * (static_cast<float>(w[i]) * part);
    return sum;
}

std::uint32_t TetraRefinement::group_in(std::uint32_t tetra, Kind kind, std::uint32_t part) const {
    if (kind == Kind::inside) return TetraPattern::kInside;
    const Parts& p = parts_[tetra];
    std::uint32_t group = kind == Kind::vertex ? 0 : kind == Kind::edge ? kFirstEdge : kFirstFace;
    while (p[group] != part) ++group;
    return group;
}

}  // namespace coppice
