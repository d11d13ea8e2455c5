#pragma once

#include <array>
#include <cstdint>
#include <span>

#include "coppice/foliage/placement.h"
#include "coppice/foliage/shoots_internal.h"
#include "coppice/mesh/instances.h"

namespace coppice::foliage_internal {

/// Random numbers of one leaf.
struct LeafDraws {
    std::array<float, 4> uniform{};  ///< in [0, 1)
    std::array<float, 5> normal{};   ///< mean 0, standard deviation 1, in [-3, 3]
    std::uint64_t bits = 0;          ///< 64 random bits
};

/// Returns the numbers of the leaf of this index on a shoot, which has a key.
LeafDraws draw_leaf(std::uint64_t key, std::uint64_t index);

/// The place of a leaf in space.
struct LeafFrame {
    Vec3 attachment;  ///< [m] on the bark
    Vec3 along;       ///< unit vector from the attachment to the tip
    Vec3 up;          ///< unit vector, the direction of the upper side
};

/// Returns the frame of leaf `index` of a node: `node` counts nodes from the tip; `start` [rad] is the
/// direction of the first leaf of the shoot.
/// `opening` is a factor of the angle of the petiole.
LeafFrame make_frame(const ShootPlace& place, const LeafRules& rules, std::uint32_t node, std::uint32_t index,
                     float start, float opening, const LeafDraws& draws);

/// Returns the rotation from the frame of a prototype.
Quaternion make_rotation(const LeafFrame& frame);

/// Returns the share of leaves that may be kept so that the index in summer is at most rules.max_index. Few
/// leaves cover a smaller area, so that the share is found in several steps.
float find_density(const Skeleton& skeleton, std::span<const LeafModel> models, const LeafRules& rules,
                   const Context& ctx);

/// The effects of the season.
struct SeasonState {
    float size = 1;           ///< factor of sizes
    float angle = 1;          ///< factor of the angle of the petiole
    float density = 1;        ///< share of leaves that have not fallen
    std::array<Vec3, 2> hue;  ///< sRGB between which the colours of leaves vary
};

/// The effects of the season on leaves by their age.
class SeasonEffects {
  public:
    /// Throws InvalidInput for colours that are not in [0, 1].
    explicit SeasonEffects(const LeafRules& rules);

    /// Returns the effects on a leaf; `from_tip` is 0 at the tip of the shoot.
    SeasonState find(float from_tip) const;

  private:
    Season season_;
    bool evergreen_;
    Vec3 young_, summer_, autumn_;
};

/// Returns the colour of a leaf. `mix` in [0, 1] selects the hue, `light` in [0, 1] the brightness.
std::array<std::uint8_t, 3> make_color(const SeasonState& season, const LeafRules& rules, float mix,
                                       float light);

}  // namespace coppice::foliage_internal
