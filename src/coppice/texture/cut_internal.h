#pragma once

#include <cstdint>
#include <vector>

#include "coppice/texture/cut.h"
#include "coppice/texture/lattice_internal.h"

namespace coppice::texture_internal {

/// A point of a cut.
struct Polar {
    float radius;  ///< [m] from the pith
    float angle;   ///< [rad] from -pi to pi
};

/// Noise that continues around a circle, mostly in [-1, 1].
class PolarNoise {
  public:
    /// `waves`: around the circle; `length`: of a wave along the radius, which is 1.
    PolarNoise(std::uint64_t seed, std::uint64_t stage, float waves, float length);

    /// Returns the value at a share of the radius in [0, 1].
    float operator()(float angle, float share) const;

  private:
    static constexpr int kColumns = 1024, kRows = 65;
    std::vector<float> values_;  // row by row
};

/// The annual rings of a stem. Their widths vary from year to year.
class Rings {
  public:
    /// `radius` [m] of the wood, `width` [m] mean width of a ring.
    Rings(float radius, float width, std::uint64_t seed);

    /// A place in a ring.
    struct Ring {
        float position;  ///< from 0 at its inner border to 1
        float width;     ///< [m]
        float tone;      ///< random number of the ring in [0, 1)
    };
    /// Returns the ring at a share of the radius; beyond 1, that of the end.
    Ring at(float share) const;

  private:
    float radius_;
    std::vector<float> borders_;        // shares of the radius, from 0 to 1
    std::vector<float> tones_;          // per ring
    std::vector<std::uint32_t> first_;  // ring at the beginning of each of the equal parts of the radius
};

/// Rays along the radius. Additional ones begin where their distance would become larger than the mean.
class Rays {
  public:
    Rays(const CutOptions& options, float radius, std::uint64_t seed);

    /// Returns the visibility of the rays at a point, from 0 to 1. `texel` [m].
    float at(Polar p, float texel) const;

  private:
    struct Layer {
        float begin;                                 // [m] radius
        std::vector<float> angles, strengths, ends;  // per ray; ends [m]
    };
    float amount_;
    std::vector<Layer> layers_;
};

/// Cracks along the radius, which open towards the bark, and a small star of them at the pith.
class Cracks {
  public:
    Cracks(const CutOptions& options, float radius, std::uint64_t seed);

    /// Returns how far a point is inside a crack, from 0 to 1. `wave` in [-1, 1] bends them; `texel` [m].
    float at(Polar p, float wave, float texel) const;

  private:
    struct Crack {
        float angle, begin, end, width;  // [rad], [m]; `width` at the end
        bool opens_outwards;
    };
    std::vector<Crack> cracks_;
};

}  // namespace coppice::texture_internal
