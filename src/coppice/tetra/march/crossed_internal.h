#pragma once

#include <bit>
#include <cstdint>
#include <span>
#include <vector>

#include "coppice/base/parallel.h"
#include "coppice/tetra/march/cuts_internal.h"

namespace coppice::tetra_internal {

/// Intersection of the surface with one fine tetrahedron of a coarse one: an index in kCuts.
struct Crossing {
    std::uint16_t fine;
    std::uint8_t code;

    const Cut& cut() const { return kCuts[code]; }
    /// Returns whether a corner is on the surface, even if the cut polygon does not use it.
    bool any_on() const { return (code & 15) != 0; }
};

/// The fine tetrahedra that the surface crosses, in order, in chunks of a few regions each.
class CrossedTetra {
  public:
    struct Chunk {
        std::vector<std::uint32_t> active;  ///< coarse tetrahedra with corners on both sides, ascending
        std::vector<std::uint32_t> end;     ///< for each: the end of its crossings
        std::vector<Crossing> crossings;

        std::span<const Crossing> of(std::size_t i) const {
            const std::uint32_t first = i == 0 ? 0 : end[i - 1];
            return std::span(crossings).subspan(first, end[i] - first);
        }
    };

    CrossedTetra(const TetraRefinement& refinement, const Samples& samples, const Context& ctx);

    /// Recomputes the chunks that contain one of these coarse tetrahedra, which must be ascending.
    void update(std::span<const std::uint32_t> tetra, const Context& ctx);

    std::span<const Chunk> chunks() const { return chunks_; }
    std::uint64_t count() const;  ///< number of fine tetrahedra
    IndexRange regions(std::size_t chunk) const;

  private:
    void list(std::size_t chunk);

    const TetraRefinement& refinement_;
    const Samples& samples_;
    std::vector<Chunk> chunks_;
};

/// The fine edges of a coarse tetrahedron with a vertex of the surface in their interior.
class CutEdges {
  public:
    void assign(const TetraPattern& pattern, std::span<const Crossing> crossings) {
        words_.assign(pattern.edges.size() / 64 + 1, 0);
        for (const Crossing& crossing : crossings) {
            const Cut& cut = crossing.cut();
            for (std::size_t k = 0; k < cut.size; ++k) {
                if (cut.corners[k] >= kCutVertex) continue;
                const std::uint32_t e = pattern.tetra_edges[crossing.fine][cut.corners[k]];
                words_[e / 64] |= std::uint64_t{1} << (e % 64);
            }
        }
    }

    /// Calls use(edge) for the cut edges in a group, in order.
    template <class Use>
    void for_each(const TetraPattern& pattern, std::uint32_t group, const Use& use) const {
        const std::uint32_t first = pattern.first_edge[group], last = pattern.first_edge[group + 1];
        for (std::uint32_t start = first; start < last; start = start / 64 * 64 + 64) {
            std::uint64_t word = words_[start / 64] >> (start % 64) << (start % 64);
            const std::uint32_t beyond = start / 64 * 64 + 64;
            if (last < beyond) word &= (std::uint64_t{1} << (last % 64)) - 1;
            for (; word != 0; word &= word - 1)
                use(start / 64 * 64 + static_cast<std::uint32_t>(std::countr_zero(word)));
        }
    }

  private:
    std::vector<std::uint64_t> words_;
};

/// Numbers of all fine edges that the surface cuts.
class CutNumbers {
  public:
    CutNumbers(const TetraRefinement& refinement, const CrossedTetra& crossed, const Context& ctx);

    std::uint64_t count() const { return count_; }

    /// Calls use(group, number) for the groups of fine edges that a coarse tetrahedron owns, with the number
    /// of the first cut edge; the others follow.
    template <class Use>
    void for_each_owned(std::uint32_t t, const Use& use) const {
        for_each_holder(t, [&](std::uint32_t group, std::size_t holder) {
            if ((refinement_.owned(t) >> group & 1) != 0) use(group, first_[holder]);
        });
    }

    /// Writes the numbers of a coarse tetrahedron's cut edges to `out`, indexed by local edge number.
    void number_edges(std::uint32_t t, const CutEdges& edges, std::vector<std::uint32_t>& out) const;

  private:
    /// Calls use(group, holder) for the elements of a coarse tetrahedron that contain fine edges: edges,
    /// faces, and the interior.
    template <class Use>
    void for_each_holder(std::uint32_t t, const Use& use) const {
        const auto& elements = refinement_.elements(t);
        const std::size_t faces = refinement_.edge_count(), insides = faces + refinement_.face_count();
        for (std::uint32_t g = 4; g < TetraPattern::kGroups; ++g)
            use(g, g < 10 ? elements[g] : g < TetraPattern::kInside ? faces + elements[g] : insides + t);
    }

    const TetraRefinement& refinement_;
    Buffer<std::uint32_t> first_;  ///< by holder
    std::uint64_t count_ = 0;
};

}  // namespace coppice::tetra_internal
