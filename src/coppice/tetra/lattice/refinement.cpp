#include "coppice/tetra/lattice/refinement.h"

#include <fmt/format.h>

#include <algorithm>
#include <atomic>
#include <limits>
#include <utility>

#include "coppice/base/id.h"
#include "coppice/base/parallel.h"
#include "coppice/tetra/lattice/shape_kernel.h"

namespace coppice {

namespace {

using Local = TetraPattern::Local;
using Kind = TetraRefinement::Kind;

constexpr std::size_t kRefinementGrain = 2048;            // tetrahedra
constexpr std::uint32_t kFirstEdge = 4, kFirstFace = 10;  // groups

/// Returns whether a group of the pattern is in the face opposite a corner.
bool is_in_face(std::uint32_t group, std::uint32_t opposite) {
    if (group < kFirstEdge) return group != opposite;
    if (group >= kFirstFace) return group == kFirstFace + opposite;
    const auto [a, b] = kTetraEdges[group - kFirstEdge];
    return a != opposite && b != opposite;
}

/// The edges or faces that have one vertex as their smallest; they are few, so a linear search is fast.
class ByLeastVertex {
  public:
    void clear() { keys_.clear(); }
    std::size_t size() const { return keys_.size(); }

    /// Returns the number of the element with these other vertices; adds it if it is new.
    std::uint32_t find(std::uint64_t key) {
        const auto at = std::ranges::find(keys_, key);
        const auto number = static_cast<std::uint32_t>(at - keys_.begin());
        if (at == keys_.end()) keys_.push_back(key);
        return number;
    }

  private:
    std::vector<std::uint64_t> keys_;
};

/// Calls visit for the edges, or faces, that have corner c of a tetrahedron as their smallest vertex.
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

std::uint32_t find_corner(const TetraRefinement::Elements& elements, std::uint32_t vertex) {
    return static_cast<std::uint32_t>(std::find(elements.begin(), elements.begin() + 3, vertex) -
                                      elements.begin());
}

}  // namespace

TetraRefinement::TetraRefinement(const TetraMesh& coarse, int levels, const Context& ctx)
    : coarse_(coarse), levels_(levels) {
    if (levels < 0 || levels > TetraPattern::kMaxLevels) {
        throw InvalidInput(fmt::format("tetra refinement: levels must be between 0 and {}, but is {}",
                                       TetraPattern::kMaxLevels, levels));
    }
    check(ctx);
    describe(ctx);
    find_vertex_stars(ctx);
    ctx.throw_if_cancelled();
    find_elements(ctx);

    vertices_.per_kind = fine_vertices_per_part(levels);
    const std::uint64_t total =
        vertices_.begin_kinds({coarse.positions.size(), edge_count(), face_count(), coarse.tetra.size()});
    if (total > kMaxVertices) {
        throw InvalidInput(
            fmt::format("tetra refinement: levels = {} makes more than {} vertices of {} tetrahedra; reduce "
                        "the number of levels",
                        levels, kMaxVertices, coarse.tetra.size()));
    }
    vertex_count_ = static_cast<std::uint32_t>(total);
    for (std::uint32_t d = 0; d < 3; ++d) patterns_[d] = tetra_pattern(levels, d);
}

void TetraRefinement::check(const Context& ctx) const {
    const auto& tetra = coarse_.tetra;
    if (coarse_.positions.size() >= kNoIndex / 4 || tetra.size() >= kNoIndex / 8)
        throw InvalidInput("tetra refinement: more than 2^29 tetrahedra; make them larger");
    if (coarse_.first.empty() || coarse_.first.front() != 0 || coarse_.first.back() != tetra.size() ||
        !std::ranges::is_sorted(coarse_.first))
        throw InvalidInput("tetra refinement: the regions do not cover the tetrahedra one after the other");
    const auto bad = [&](const Tetra& t) {
        if (std::ranges::any_of(t, [&](std::uint32_t v) { return v >= coarse_.positions.size(); }))
            return true;
        return !tetra_kernel::is_sound(tetra_kernel::get_corners(coarse_.positions.data(), t));
    };
    const auto first_bad = parallel_reduce(
        ctx, tetra.size(), kRefinementGrain, tetra.size(),
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
    elements_.resize(count);
    traits_.resize(count);
    parallel_for(ctx, count, kRefinementGrain, [&](std::size_t t) {
        tetra_kernel::describe_tetra(coarse_.positions.data(), coarse_.tetra[t], levels_, elements_[t],
                                     traits_[t]);
    });
}

void TetraRefinement::find_vertex_stars(const Context& ctx) {
    const std::size_t tetra = coarse_.tetra.size();
    first_at_vertex_.assign(coarse_.positions.size() + 1, 0);
    parallel_for(ctx, tetra, kRefinementGrain, [&](std::size_t t) {
        for (const std::uint32_t v : coarse_.tetra[t])
            std::atomic_ref(first_at_vertex_[v]).fetch_add(1, std::memory_order_relaxed);
    });
    exclusive_scan(std::span(first_at_vertex_));
    Buffer<std::uint32_t> next(first_at_vertex_);
    at_vertex_.resize(4 * tetra);
    parallel_for(ctx, tetra, kRefinementGrain, [&](std::size_t t) {
        for (const std::uint32_t v : coarse_.tetra[t]) {
            const std::uint32_t at = std::atomic_ref(next[v]).fetch_add(1, std::memory_order_relaxed);
            at_vertex_[at] = static_cast<std::uint32_t>(t);
        }
    });
    // The previous loop stores them in the order of the threads.
    parallel_for(ctx, coarse_.positions.size(), kRefinementGrain, [&](std::size_t v) {
        std::sort(at_vertex_.begin() + first_at_vertex_[v], at_vertex_.begin() + first_at_vertex_[v + 1]);
    });
}

/// Every vertex numbers the edges and faces that have it as their smallest vertex, in the order in which the
/// tetrahedra around it list them.
void TetraRefinement::find_elements(const Context& ctx) {
    constexpr std::size_t kVertexGrain = 512;
    const std::size_t vertices = coarse_.positions.size();
    first_edge_.assign(vertices + 1, 0);
    first_face_.assign(vertices + 1, 0);
    struct Found {
        std::vector<float> edges, faces;  ///< [m] for each, the shortest fine edge around it
        std::vector<TetraFace> hull;      ///< faces of only one tetrahedron, opposite a vertex of `elements`
        std::uint32_t crowded = kNoIndex;
    };
    std::vector<Found> found((vertices + kVertexGrain - 1) / kVertexGrain);
    parallel_for_ranges(ctx, vertices, kVertexGrain, [&](IndexRange r) {
        Found& f = found[r.begin / kVertexGrain];
        ByLeastVertex edges, faces;
        std::vector<TetraFace> first_side;
        std::vector<std::uint32_t> sides;
        for (std::size_t v = r.begin; v < r.end; ++v) {
            edges.clear();
            faces.clear();
            first_side.clear();
            sides.clear();
            const std::size_t edges_before = f.edges.size(), faces_before = f.faces.size();
            bool first = true;
            for (const std::uint32_t t : at_vertex(static_cast<std::uint32_t>(v))) {
                Elements& p = elements_[t];
                const float shortest = traits_[t].shortest_edge;
                const std::uint32_t c = find_corner(p, static_cast<std::uint32_t>(v));
                // Registers an edge or face at this vertex; its first tetrahedron owns it.
                const auto note = [&](ByLeastVertex& of_kind, std::vector<float>& all, std::size_t before,
                                      std::uint32_t group, std::uint64_t key) {
                    const std::uint32_t i = p[group] = of_kind.find(key);
                    if (before + i == all.size()) {
                        own(t, group);
                        all.push_back(shortest);
                        return std::pair(i, true);
                    }
                    all[before + i] = std::min(all[before + i], shortest);
                    return std::pair(i, false);
                };
                if (std::exchange(first, false)) own(t, c);
                for_each_edge_above(c, [&](std::uint32_t group, std::uint32_t b) {
                    note(edges, f.edges, edges_before, group, p[b]);
                });
                for_each_face_above(c, [&](std::uint32_t group, std::uint32_t b, std::uint32_t d) {
                    const auto [i, is_new] =
                        note(faces, f.faces, faces_before, group, std::uint64_t{p[b]} << 32 | p[d]);
                    if (is_new) {
                        first_side.push_back({t, group - kFirstFace});
                        sides.push_back(0);
                    }
                    if (++sides[i] > 2) f.crowded = std::min(f.crowded, t);
                });
            }
            for (std::size_t i = 0; i < sides.size(); ++i) {
                if (sides[i] == 1) f.hull.push_back(first_side[i]);
            }
            first_edge_[v] = static_cast<std::uint32_t>(edges.size());
            first_face_[v] = static_cast<std::uint32_t>(faces.size());
        }
    });
    std::uint32_t crowded = kNoIndex;
    for (const Found& f : found) crowded = std::min(crowded, f.crowded);
    if (crowded != kNoIndex) {
        throw InvalidInput(fmt::format(
            "tetra refinement: tetrahedron {} has a face with more than one other; remove all but two",
            crowded));
    }
    const std::uint32_t edge_count = exclusive_scan(std::span(first_edge_));
    shortest_at_.resize(vertices + edge_count + exclusive_scan(std::span(first_face_)));
    parallel_for(ctx, elements_.size(), kRefinementGrain, [&](std::size_t t) {
        Elements& p = elements_[t];
        for (std::uint32_t e = 0; e < 6; ++e) p[kFirstEdge + e] += first_edge_[p[kTetraEdges[e][0]]];
        for (std::uint32_t f = 0; f < 4; ++f) p[kFirstFace + f] += first_face_[p[f == 0 ? 1 : 0]];
    });
    parallel_for(ctx, vertices, kRefinementGrain, [&](std::size_t v) {
        float shortest = std::numeric_limits<float>::infinity();
        for (const std::uint32_t t : at_vertex(static_cast<std::uint32_t>(v)))
            shortest = std::min(shortest, traits_[t].shortest_edge);
        shortest_at_[v] = shortest;
    });
    parallel_for(ctx, found.size(), 1, [&](std::size_t i) {
        const auto out = shortest_at_.begin();
        std::ranges::copy(found[i].edges, out + vertices + first_edge_[kVertexGrain * i]);
        std::ranges::copy(found[i].faces, out + vertices + edge_count + first_face_[kVertexGrain * i]);
    });
    parallel_for(ctx, found.size(), 1, [&](std::size_t i) {
        for (const TetraFace& f : found[i].hull) {
            for (std::uint32_t g = 0; g < TetraPattern::kInside; ++g) {
                if (is_in_face(g, f.opposite))
                    std::atomic_ref(shortest_at_[part_index(f.tetra, g)]).store(0, std::memory_order_relaxed);
            }
        }
    });
}

std::vector<std::uint32_t> TetraRefinement::around(Kind kind, std::uint32_t part) const {
    if (kind == Kind::inside) return {part};
    std::uint32_t vertex = part;
    if (kind != Kind::vertex) {
        const auto& first = kind == Kind::edge ? first_edge_ : first_face_;
        vertex = static_cast<std::uint32_t>(std::ranges::upper_bound(first, part) - first.begin()) - 1;
    }
    std::vector<std::uint32_t> out;
    for (const std::uint32_t t : at_vertex(vertex)) {
        if (group_in(t, kind, part) < TetraPattern::kGroups) out.push_back(t);
    }
    return out;
}

RefinementView TetraRefinement::view() const {
    RefinementView out;
    out.positions = coarse_.positions;
    out.elements = elements_;
    out.traits = traits_;
    out.shortest_at = shortest_at_;
    const auto vertices = static_cast<std::uint32_t>(coarse_.positions.size());
    out.first_element = {0, vertices, vertices + edge_count(), vertices + edge_count() + face_count()};
    for (std::size_t d = 0; d < 3; ++d) out.patterns[d] = make_view(patterns_[d]);
    out.vertices = vertices_;
    out.edges.per_kind = fine_edges_per_part(patterns_[0]);
    out.edge_count =
        out.edges.begin_kinds({coarse_.positions.size(), edge_count(), face_count(), coarse_.tetra.size()});
    out.levels = levels_;
    return out;
}

std::uint32_t TetraRefinement::group_in(std::uint32_t tetra, Kind kind, std::uint32_t part) const {
    if (kind == Kind::inside) return TetraPattern::kInside;
    constexpr std::array<std::uint32_t, 4> kFirst{0, kFirstEdge, kFirstFace, TetraPattern::kInside};
    const auto k = static_cast<std::size_t>(kind);
    const Elements& p = elements_[tetra];
    std::uint32_t group = kFirst[k];
    while (group < kFirst[k + 1] && p[group] != part) ++group;
    return group < kFirst[k + 1] ? group : TetraPattern::kGroups;
}

}  // namespace coppice
