#include "coppice/tetra/march/solid_internal.h"

#include <algorithm>
#include <limits>

#include "coppice/base/id.h"
#include "coppice/base/parallel.h"

namespace coppice::tetra_internal {
namespace {

using Local = TetraPattern::Local;
using Ids = std::array<std::uint32_t, 4>;

constexpr std::uint32_t edge_between(std::size_t a, std::size_t b) {
    std::uint32_t e = 0;
    while (kTetraEdges[e][0] != std::min(a, b) || kTetraEdges[e][1] != std::max(a, b)) ++e;
    return e;
}

/// Returns vertices moved onto the surface that no triangle uses: they are inside.
RankedBits buried_vertices(const Samples& samples, std::span<const std::uint32_t> placed) {
    RankedBits out(64 * (samples.on.words().size() - 2));
    for_each_bit(samples.on.words(), [&](std::uint32_t v) {
        if (placed[samples.placed.rank(v)] == kNoIndex) out.set(v);
    });
    return out;
}

/// Cuts the fine tetrahedra and keeps the portions inside.
class Filler {
  public:
    Filler(const TetraRefinement& refinement, const Samples& samples, const CrossedTetra& crossed,
           const SurfaceNumbers& numbers, const TriMesh& surface)
        : refinement_(refinement),
          samples_(samples),
          crossed_(crossed),
          numbers_(numbers),
          surface_(surface),
          inside_(samples.inside),
          buried_(buried_vertices(samples, numbers.placed)),
          first_inside_(static_cast<std::uint32_t>(surface.positions.size())) {
        const std::uint64_t inside = inside_.count(), buried = buried_.count();
        first_buried_ = static_cast<std::uint32_t>(first_inside_ + inside);
        count_ = first_inside_ + inside + buried;
        if (count_ >= kNoIndex)
            throw InvalidInput("march: levels makes more than 2^32 vertices; reduce the number of levels");
    }

    SolidMesh fill(const Context& ctx) const {
        SolidMesh out;
        out.origin = surface_.origin;
        out.positions = surface_.positions;
        out.positions.resize(count_);
        parallel_for(ctx, refinement_.coarse().tetra.size(), 1024,
                     [&](std::size_t t) { place(static_cast<std::uint32_t>(t), out.positions); });
        ctx.throw_if_cancelled();
        std::vector<std::vector<Ids>> elements(crossed_.chunks().size());
        parallel_for(ctx, elements.size(), 1, [&](std::size_t p) { fill_chunk(p, elements[p]); });
        ctx.throw_if_cancelled();
        std::vector<std::size_t> first;
        for (const auto& part : elements) first.push_back(part.size());
        out.tetra.resize(exclusive_scan<std::size_t>(first));
        parallel_for(ctx, elements.size(), 1, [&](std::size_t p) {
            for (std::size_t i = 0; i < elements[p].size(); ++i)
                out.tetra[first[p] + i] = turned(elements[p][i], out.positions);
        });
        return out;
    }

  private:
    /// Returns the number of a fine vertex that is inside or on the surface.
    std::uint32_t get_number(std::uint32_t vertex) const {
        if (inside_.test(vertex)) return first_inside_ + inside_.rank(vertex);
        if (buried_.test(vertex)) return first_buried_ + buried_.rank(vertex);
        return numbers_.placed[samples_.placed.rank(vertex)];
    }

    /// Stores the positions of the inner vertices that a coarse tetrahedron owns.
    void place(std::uint32_t t, Buffer<Vec3>& positions) const {
        const auto& first = refinement_.pattern(t).first_vertex;
        for (std::uint32_t g = 0; g < TetraPattern::kGroups; ++g) {
            if ((refinement_.owned(t) >> g & 1) == 0) continue;
            for (std::uint32_t v = first[g]; v < first[g + 1]; ++v) {
                const auto local = static_cast<Local>(v);
                const std::uint32_t vertex = refinement_.vertex(t, local);
                if (!inside_.test(vertex) && !buried_.test(vertex)) continue;
                positions[get_number(vertex)] = samples_.moved.test(vertex)
                                                    ? samples_.place[samples_.placed.rank(vertex)]
                                                    : refinement_.position(t, local);
            }
        }
    }

    void fill_chunk(std::size_t p, std::vector<Ids>& out) const {
        const CrossedTetra::Chunk& chunk = crossed_.chunks()[p];
        const auto& first = refinement_.coarse().first;
        const IndexRange regions = crossed_.regions(p);
        LocalSigns signs;
        CutEdges edges;
        std::vector<std::uint32_t> of_edge;
        std::size_t active = 0;
        for (std::uint32_t t = first[regions.begin]; t < first[regions.end]; ++t) {
            const TetraPattern& pattern = refinement_.pattern(t);
            if (active == chunk.active.size() || chunk.active[active] != t) {
                if (!inside_.test(refinement_.vertex(t, 0))) continue;
                for (const auto& fine : pattern.tetra) out.push_back(whole(t, fine));
                continue;
            }
            signs.gather(refinement_, samples_, t);
            edges.assign(pattern, chunk.of(active++));
            numbers_.cuts.number_edges(t, edges, of_edge);
            for (std::size_t f = 0; f < pattern.tetra.size(); ++f)
                cut(t, f, signs.code(pattern.tetra[f]), of_edge, out);
        }
    }

    Ids whole(std::uint32_t t, const std::array<Local, 4>& fine) const {
        Ids out;
        for (std::size_t i = 0; i < 4; ++i) out[i] = get_number(refinement_.vertex(t, fine[i]));
        return out;
    }

    /// Appends the inner portion of a fine tetrahedron.
    void cut(std::uint32_t t, std::size_t f, std::uint8_t code, const std::vector<std::uint32_t>& of_edge,
             std::vector<Ids>& out) const {
        const TetraPattern& pattern = refinement_.pattern(t);
        const auto& fine = pattern.tetra[f];
        std::array<std::size_t, 4> order{0, 1, 2, 3};
        const auto is_inside = [&](std::size_t i) { return (code >> (4 + i) & 1) != 0; };
        const auto is_on = [&](std::size_t i) { return (code >> i & 1) != 0; };
        std::ranges::sort(order, {}, [&](std::size_t i) {
            return std::pair(!is_inside(i), refinement_.vertex(t, fine[i]));
        });
        const auto corner = [&](std::size_t i) { return get_number(refinement_.vertex(t, fine[order[i]])); };
        // Returns the vertex of the surface on the edge from an inner corner to another one.
        const auto end = [&](std::size_t i, std::size_t j) {
            if (is_on(order[j])) return corner(j);
            return numbers_.placed_count + of_edge[pattern.tetra_edges[f][edge_between(order[i], order[j])]];
        };
        const auto add = [&](Ids ids) {
            for (std::size_t i = 0; i < 4; ++i) {
                for (std::size_t j = 0; j < i; ++j) {
                    if (ids[i] == ids[j]) return;
                }
            }
            out.push_back(ids);
        };
        const auto inner = static_cast<std::size_t>(std::popcount(static_cast<unsigned>(code >> 4)));
        if (inner == 4) {
            add(whole(t, fine));
        } else if (inner == 1) {
            add({corner(0), end(0, 1), end(0, 2), end(0, 3)});
        } else if (inner == 2) {
            const std::uint32_t a = corner(0), b = corner(1), ac = end(0, 2), ad = end(0, 3), bc = end(1, 2),
                                bd = end(1, 3);
            add({a, b, bc, bd});
            const bool from_ac = ac == bc || ad == bd || cuts_through(ac, t, f, code, of_edge);
            add(from_ac ? Ids{a, ac, bc, bd} : Ids{a, ac, bc, ad});
            add(from_ac ? Ids{a, ac, bd, ad} : Ids{a, bc, bd, ad});
        } else if (inner == 3) {
            const std::uint32_t a = corner(0), b = corner(1), c = corner(2), ad = end(0, 3), bd = end(1, 3),
                                cd = end(2, 3);
            add({a, b, c, cd});
            add({a, b, bd, cd});
            add({a, ad, bd, cd});
        }
    }

    /// Returns whether the quadrilateral of the surface in a fine tetrahedron is cut from this corner.
    bool cuts_through(std::uint32_t number, std::uint32_t t, std::size_t f, std::uint8_t code,
                      const std::vector<std::uint32_t>& of_edge) const {
        const Cut& cut = kCuts[code];
        Ids corners;
        for (std::size_t k = 0; k < 4; ++k)
            corners[k] =
                numbers_.placed_count + of_edge[refinement_.pattern(t).tetra_edges[f][cut.corners[k]]];
        if (refinement_.mirrored(t)) std::ranges::reverse(corners);
        const bool is_first = corners[0] == number || corners[2] == number;
        return tetra_kernel::cut_from_first(surface_.positions.data(), corners) == is_first;
    }

    static Ids turned(Ids t, std::span<const Vec3> p) {
        const Vec3d a(p[t[0]]), b(p[t[1]]), c(p[t[2]]), d(p[t[3]]);
        if (dot(cross(b - a, c - a), d - a) < 0) std::swap(t[2], t[3]);
        return t;
    }

    const TetraRefinement& refinement_;
    const Samples& samples_;
    const CrossedTetra& crossed_;
    const SurfaceNumbers& numbers_;
    const TriMesh& surface_;
    RankedBits inside_, buried_;
    std::uint32_t first_inside_, first_buried_ = 0;
    std::uint64_t count_ = 0;
};

}  // namespace

SolidMesh fill(const TetraRefinement& refinement, const Samples& samples, const CrossedTetra& crossed,
               const SurfaceNumbers& numbers, const TriMesh& surface, const Context& ctx) {
    return Filler(refinement, samples, crossed, numbers, surface).fill(ctx);
}

}  // namespace coppice::tetra_internal
