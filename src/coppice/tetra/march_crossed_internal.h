#pragma once

#include <bit>
#include <cstdint>
#include <span>
#include <vector>

#include "coppice/base/parallel.h"
#include "coppice/tetra/march_internal.h"

namespace coppice::march_detail {

/// How the surface crosses one fine tetrahedron of a coarse one: a number in kCuts.
struct Crossing {
    std::uint16_t fine;
    std::uint8_t code;

    const Cut& cut() const { return kCuts[code]; }
};

/// The fine tetrahedra that the surface crosses, in pieces of a few regions each, and in order.
class CrossedTetra {
  public:
    struct Piece {
        std::vector<std::uint32_t> active;  ///< coarse tetrahedra with corners on both sides, ascending
        std::vector<std::uint32_t> end;     ///< of each: the end of its crossings
        std::vector<Crossing> crossings;

        std::span<const Crossing> of(std::size_t i) const {
            const std::uint32_t first = i == 0 ? 0 : end[i - 1];
            return std::span(crossings).subspan(first, end[i] - first);
        }
    };

    CrossedTetra(const TetraRefinement& refinement, const Samples& samples, const Context& ctx);

    /// Looks again at the pieces that hold one of these coarse tetrahedra, ascending.
    void update(std::span<const std::uint32_t> tetra, const Context& ctx);

    std::span<const Piece> pieces() const { return pieces_; }
    IndexRange regions(std::size_t piece) const;

  private:
    void list(std::size_t piece);

    const TetraRefinement& refinement_;
    const Samples& samples_;
    std::vector<Piece> pieces_;
};

/// The fine edges of a coarse tetrahedron that have a vertex of the surface inside.
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

    /// Calls use(edge) for those in a group, in order.
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

/// Number of the part of a group among those that hold fine edges: edges, faces, insides.
inline std::uint32_t edge_holder(const TetraRefinement& refinement, std::uint32_t t, std::uint32_t group) {
    if (group < 10) return refinement.parts(t)[group];
    if (group < TetraPattern::kInside) return refinement.edge_count() + refinement.parts(t)[group];
    return refinement.edge_count() + refinement.face_count() + t;
}

}  // namespace coppice::march_detail
