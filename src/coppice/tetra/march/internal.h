#pragma once

#include <array>
#include <bit>
#include <cmath>
#include <cstdint>
#include <limits>
#include <span>
#include <vector>

#include "coppice/implicit/field_ref.h"
#include "coppice/mesh/mesh.h"
#include "coppice/tetra/lattice/refinement.h"
#include "coppice/tetra/march/march.h"

namespace coppice::tetra_internal {

/// Points asked of the field at once.
inline constexpr std::size_t kBatch = 512;

/// A field as a function that is 0 on its surface, above inside, and near to a straight line across it; never
/// NaN or infinite.
class Profile {
  public:
    explicit Profile(float level) : level_(level) {}

    float height(float value) const {
        constexpr float kMost = 1e12f;
        if (level_ <= 0) {
            if (std::isnan(value)) return -1;
            return std::clamp(value - level_, -kMost, kMost);
        }
        if (!(value > 0)) return -1;
        const float h = std::pow(std::min(value / level_, kMost), kPower) - 1;
        // Rounding must not change the side.
        return value > level_ ? std::max(h, std::numeric_limits<float>::min()) : std::min(h, 0.0f);
    }

    /// Change of the height per change of the value, there.
    float slope(float value) const {
        if (level_ <= 0) return 1;
        return value > 0 ? kPower * (1 + height(value)) / value : 0;
    }

  private:
    static constexpr float kPower = 0.4f;
    float level_;
};

/// One bit per item, and the number of set bits before each word.
class RankedBits {
  public:
    explicit RankedBits(std::size_t count) : words_(count / 64 + 2) {}

    std::span<const std::uint64_t> words() const { return words_; }
    std::span<std::uint64_t> words() { return words_; }
    bool test(std::size_t i) const { return (words_[i / 64] >> (i % 64) & 1) != 0; }
    void set(std::size_t i) { words_[i / 64] |= std::uint64_t{1} << (i % 64); }
    void reset(std::size_t i) { words_[i / 64] &= ~(std::uint64_t{1} << (i % 64)); }

    /// Counts anew; returns the number of set bits.
    std::uint32_t count() {
        before_.resize(words_.size());
        std::uint32_t sum = 0;
        for (std::size_t w = 0; w < words_.size(); ++w) {
            before_[w] = sum;
            sum += static_cast<std::uint32_t>(std::popcount(words_[w]));
        }
        return sum;
    }
    /// Set bits before i when they were last counted.
    std::uint32_t rank(std::size_t i) const {
        const std::uint64_t below = words_[i / 64] & ((std::uint64_t{1} << (i % 64)) - 1);
        return before_[i / 64] + static_cast<std::uint32_t>(std::popcount(below));
    }

  private:
    std::vector<std::uint64_t> words_;
    std::vector<std::uint32_t> before_;
};

/// Calls use(i) for every set bit, in order.
template <class Use>
void for_each_bit(std::span<const std::uint64_t> words, const Use& use) {
    for (std::size_t w = 0; w < words.size(); ++w) {
        for (std::uint64_t rest = words[w]; rest != 0; rest &= rest - 1)
            use(static_cast<std::uint32_t>(64 * w) + static_cast<std::uint32_t>(std::countr_zero(rest)));
    }
}

/// What is known of every fine vertex. A vertex that lies on the surface counts as outside.
struct Samples {
    Buffer<float> height;  ///< of the profile, where the vertex was before it was moved
    RankedBits inside;
    RankedBits on;       ///< moved onto the surface and not put back
    RankedBits placed;   ///< all that were near enough; ranked
    Buffer<Vec3> place;  ///< [m] by rank in `placed`: on the surface
    Buffer<float> way;   ///< [m] by rank in `placed`: how far they were moved
};

/// Samples the fine vertices, and finds where those near the surface would come to lie on it. `on` is that of
/// all that were near enough.
Samples sample_vertices(const TetraRefinement& refinement, FieldRef field, float snap, const Context& ctx);

/// Hull faces with vertices on both sides, ascending.
std::vector<TetraFace> open_faces(const TetraRefinement& refinement, const RankedBits& inside,
                                  const Context& ctx);

/// The polygon of the surface within a fine tetrahedron, counter-clockwise seen from outside. Corners 0 to 5
/// lie on edges 01, 02, 03, 12, 13, 23; corners 6 to 9 are the vertices 0 to 3.
struct Cut {
    std::uint8_t size = 0;  ///< 0, 3 or 4
    std::array<std::uint8_t, 4> corners{};
};
inline constexpr std::uint8_t kCutVertex = 6;

/// By 16 times the bits of the corners that are inside, and the bits of those on the surface.
extern const std::array<Cut, 256> kCuts;

/// One bit for each fine vertex of a coarse tetrahedron: for the 6545 of 5 levels, and two words to spare.
using LocalBits = std::array<std::uint64_t, 105>;

/// Gathers a coarse tetrahedron's from those of all fine vertices. Words beyond them are unspecified.
void gather_bits(const TetraRefinement& refinement, const RankedBits& bits, std::uint32_t tetra,
                 LocalBits& out);

inline std::uint32_t bit_of(const LocalBits& words, std::uint32_t i) {
    return static_cast<std::uint32_t>(words[i / 64] >> (i % 64)) & 1;
}

/// The signs of one coarse tetrahedron's fine vertices.
class LocalSigns {
  public:
    /// Returns whether some are inside and some are not; otherwise nothing is known afterwards.
    bool gather(const TetraRefinement& refinement, const Samples& samples, std::uint32_t tetra);

    /// Number in kCuts of how the surface crosses a fine tetrahedron.
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
