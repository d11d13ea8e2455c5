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
#include "coppice/tetra/march.h"
#include "coppice/tetra/refinement.h"

namespace coppice::march_detail {

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

/// Puts vertices back until no fine tetrahedron is turned over or flat, and the triangles around each vertex
/// on the surface are one closed fan, or none. Returns by rank in `placed` whether a vertex on the surface
/// has triangles.
std::vector<std::uint8_t> free_vertices(const TetraRefinement& refinement, Samples& samples,
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

/// The signs of one coarse tetrahedron's fine vertices.
class LocalSigns {
  public:
    /// Returns whether some are inside and some are not; otherwise nothing is known afterwards.
    bool gather(const TetraRefinement& refinement, const Samples& samples, std::uint32_t tetra);

    /// Whether the surface has a vertex within a fine edge.
    bool is_cut(const std::array<TetraPattern::Local, 2>& edge) const {
        const auto [a, b] = edge;
        return ((bit(inside_, a) ^ bit(inside_, b)) & ~(bit(on_, a) | bit(on_, b))) != 0;
    }
    const Cut& cut(const std::array<TetraPattern::Local, 4>& t) const {
        std::uint32_t inside = 0, on = 0;
        for (std::uint32_t i = 0; i < 4; ++i) {
            inside |= bit(inside_, t[i]) << i;
            on |= bit(on_, t[i]) << i;
        }
        return kCuts[16 * inside + on];
    }
    /// Calls use(number, cut) for every fine tetrahedron that the surface crosses, in order.
    template <class Use>
    void for_each_cut(const TetraPattern& pattern, const Use& use) const {
        const bool small = !pattern.tetra_masks.empty();
        for (std::size_t t = 0; t < pattern.tetra.size(); ++t) {
            if (small) {
                const std::uint64_t mask = pattern.tetra_masks[t], in = inside_[0] & mask;
                if (in == 0 || in == mask) continue;
            }
            const Cut& c = cut(pattern.tetra[t]);
            if (c.size > 0) use(t, c);
        }
    }

  private:
    static constexpr std::size_t kWords = 105;  // for the 6545 vertices of 5 levels, and two to spare
    using Words = std::array<std::uint64_t, kWords>;
    static std::uint32_t bit(const Words& words, std::uint32_t i) {
        return static_cast<std::uint32_t>(words[i / 64] >> (i % 64)) & 1;
    }

    Words inside_, on_;
};

/// Triangles from the signs, once they are settled; `used` as free_vertices returns it.
TriMesh extract(const TetraRefinement& refinement, FieldRef field, const Samples& samples,
                std::span<const std::uint8_t> used, int refinements, MarchReport& report, const Context& ctx);

}  // namespace coppice::march_detail
