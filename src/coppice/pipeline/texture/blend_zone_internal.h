#pragma once

#include <complex>
#include <limits>
#include <vector>

#include "coppice/mesh/texture.h"

namespace coppice::pipeline_internal {

/// The part of a branch along which a second set of bark coordinates continues those on the other side of an
/// edge. Its weight falls from 1 at the edge to 0 over two radii: [tiles] the number of wraps divided by pi.
class BlendZone {
  public:
    /// Continues the number of wraps before a ring; nothing if the number does not change there. The ring is
    /// at `v` in the coordinates after it.
    BlendZone(float v, float wraps, float wraps_before)
        : begin_(v), wraps_(wraps), ratio_(wraps_before / wraps) {}

    /// Continues the coordinates of the stem at the rim of a lateral to its inside; nothing if the rim does
    /// not run around its mean. The rim is at `v` in the coordinates of the lateral. Around it, `rim` has the
    /// coordinates of the stem at equal turns, the first again at the end. The coordinates are
    /// harmonic on the lateral: a wave with k periods around it decreases by exp(-k s / r) at a distance s
    /// along it with the radius r.
    void set_rim(float v, std::vector<TexturePoint> rim);
    /// Ends the zone at `v`, where other coordinates begin.
    void end_at(float v) { max_v_ = v; }

    /// Returns the second set at a place of the branch. Anywhere along it, also beyond the zone, so that the
    /// second set is continuous where the first is.
    TextureBlend at(TexturePoint first) const;

    /// A wave around a rim, as complex numbers u + i v.
    struct Wave {
        std::complex<float> forward, backward;  ///< amplitudes counter-clockwise and clockwise
    };

  private:
    using Complex = std::complex<float>;
    TexturePoint sum_waves(float turns, float decay) const;
    TexturePoint rest_at(float turns) const;

    float begin_;
    float max_v_ = std::numeric_limits<float>::infinity();
    float wraps_;  // around the branch
    float ratio_;  // at a ring: of the number of wraps before it to that after it
    TexturePoint center_;
    std::vector<Wave> waves_;         // of the rim, by their number of periods; empty at a ring
    std::vector<TexturePoint> rest_;  // of the rim, at equal turns
};

}  // namespace coppice::pipeline_internal
