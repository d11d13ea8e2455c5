#pragma once

#include <array>
#include <cstdint>

#include "coppice/tetra/march/kernel/cut_kernel.h"
#include "coppice/tetra/march/samples_internal.h"

namespace coppice::tetra_internal {

using tetra_kernel::Cut;
using tetra_kernel::kCuts;
using tetra_kernel::kCutVertex;

/// One bit for each fine vertex of a coarse tetrahedron: up to 6545 for 5 levels, plus two extra words.
using LocalBits = std::array<std::uint64_t, 105>;

/// Gathers the bits of a coarse tetrahedron from those of all fine vertices. Words beyond them are
/// unspecified.
void gather_bits(const TetraRefinement& refinement, const RankedBits& bits, std::uint32_t tetra,
                 LocalBits& out);

inline std::uint32_t get_bit(const LocalBits& words, std::uint32_t i) {
    return static_cast<std::uint32_t>(words[i / 64] >> (i % 64)) & 1;
}

/// The signs of the fine vertices of one coarse tetrahedron.
class LocalSigns {
  public:
    /// Returns whether some vertices are inside and some are not; otherwise the state is unspecified
    /// afterwards.
    bool gather(const TetraRefinement& refinement, const Samples& samples, std::uint32_t tetra);

    /// Returns the index in kCuts of the intersection of the surface with a fine tetrahedron.
    std::uint8_t code(const std::array<TetraPattern::Local, 4>& t) const {
        return static_cast<std::uint8_t>(state_[t[0]] | state_[t[1]] << 1 | state_[t[2]] << 2 |
                                         state_[t[3]] << 3);
    }
    /// Calls use(number, code) for every fine tetrahedron that the surface crosses, in order.
    template <class Use>
    void for_each_cut(const TetraPattern& pattern, const Use& use) const {
        const bool small = !pattern.tetra_masks.empty();
        for (std::size_t t = 0; t < pattern.tetra.size(); ++t) {
            if (small) {
                const std::uint64_t mask = pattern.tetra_masks[t], in = inside_[0] & mask;
                if (in == 0 || in == mask) continue;
            }
            const std::uint8_t c = code(pattern.tetra[t]);
            if (kCuts[c].size > 0) use(t, c);
        }
    }

  private:
    LocalBits inside_, on_;
    std::array<std::uint8_t, 64 * std::tuple_size_v<LocalBits>> state_;  ///< 16 inside, 1 on the surface
};

}  // namespace coppice::tetra_internal
