#pragma once

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <limits>
#include <vector>

#include "coppice/implicit/field_ref.h"
#include "coppice/skeleton/skeleton.h"
#include "coppice/tetra/lattice/refinement.h"
#include "coppice/tetra/march/held_internal.h"
#include "coppice/tetra/march/ranked_bits_internal.h"

namespace coppice::tetra_internal {

/// Points asked of the field at once.
inline constexpr std::size_t kBatch = 512;

/// A field as a function that is 0 on its surface, greater inside, and near to a straight line across it;
/// never NaN or infinite.
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

/// A held vertex that the field puts outside or near to the surface.
struct WeakVertex {
    std::uint32_t vertex;
    float radius;  ///< [m] of the axis there
    float away;    ///< [m] from the axis, where it was before it was moved
    float height;  ///< of the profile at the place that it was moved to
};

/// What is known of every fine vertex. A vertex that lies on the surface counts as outside.
struct Samples {
    Buffer<float> height;  ///< of the profile, where the vertex was before it was moved
    RankedBits inside;
    RankedBits held;               ///< inside whatever the field says, and never on the surface
    RankedBits on;                 ///< moved onto the surface and not put back
    RankedBits moved;              ///< these, and held ones moved towards their axis and not put back
    RankedBits placed;             ///< all that were near enough, and held ones that were moved; ranked
    Buffer<Vec3> place;            ///< [m] by rank in `placed`: where they were moved
    Buffer<float> way;             ///< [m] by rank in `placed`: how far they were moved
    std::vector<WeakVertex> weak;  ///< ascending

    /// Puts a vertex back to where it was.
    void put_back(std::uint32_t vertex) {
        on.reset(vertex);
        moved.reset(vertex);
        if (height[vertex] > 0 || held.test(vertex)) inside.set(vertex);
    }
};

/// Samples the fine vertices, and finds where those near the surface would come to lie on it. `on` is that of
/// all that were near enough. Held ones are moved towards their axis where they are near the surface or
/// outside.
Samples sample_vertices(const TetraRefinement& refinement, FieldRef field, float snap,
                        const HeldVertices& held, std::span<const Segment> axes, const Context& ctx);

/// Hull faces with vertices on both sides, ascending; and if wanted those that are inside as a whole.
std::vector<TetraFace> open_faces(const TetraRefinement& refinement, const RankedBits& inside,
                                  bool with_inner, const Context& ctx);

}  // namespace coppice::tetra_internal
