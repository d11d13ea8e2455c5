#pragma once

#include <cstdint>
#include <vector>

#include "coppice/animate/pose.h"
#include "coppice/base/fields.h"
#include "coppice/skeleton/skeleton.h"

namespace coppice {

/// A wind that trees sway in.
struct WindOptions {
    float speed = 0;        ///< [m/s] mean; 0 = calm; in [0, 60]
    float azimuth = 0;      ///< [rad] where it blows to, counter-clockwise from +x seen from above
    float gusts = 0.5f;     ///< how much the speed varies, as a part of it; in [0, 1]
    float flexibility = 1;  ///< times as much as green wood of those radii bends; in [0, 1000]
    float load = 12;  ///< times the wood's own width that catches the wind, by leaves and twigs; in [0, 1000]
    int seed = 0;     ///< of gusts and phases; in [0, 2^31 - 1]
};

template <class Self, class Visitor>
requires SameOptions<Self, WindOptions>
constexpr void visit_fields(Self& o, Visitor&& visit) {
    visit(common_field("speed", "Mean wind speed in metres per second; 0 is calm", Unit::none, 0, 60),
          o.speed);
    visit(Field{"azimuth", "where the wind blows to, counter-clockwise from +x seen from above", Unit::radian,
                -6.2832, 6.2832},
          o.azimuth);
    visit(Field{"gusts", "how much the speed varies, as a part of it", Unit::none, 0, 1}, o.gusts);
    visit(common_field("flexibility", "Factor on the bending of green wood with the given radii", Unit::none,
                       0, 1000),
          o.flexibility);
    visit(Field{"load", "times the wood's own width that catches the wind, by leaves and twigs", Unit::none,
                0, 1000},
          o.load);
    visit(Field{"seed", "of the gusts and of what branch sways when", Unit::none, 0, 2147483647}, o.seed);
}

/// How a forest sways in a wind, for ever repeating: every axis is a cantilever on the one that it leaves,
/// carried along by that, bent by the pressure of the wind on it and all that it bears, and swinging at its
/// own frequency. Gusts travel with the wind, so that trees downwind sway later. Angles stay below about 50
/// degrees for each axis.
///
/// Deterministic: axes have phases by their number and the seed.
class Wind {
  public:
    /// `period` [s] after which the motion begins anew; nothing swings faster than `fastest` times in it.
    /// Throws InvalidInput where an option is out of range or the period not above 0. O(n).
    Wind(const Skeleton& rest, const WindOptions& options, double period, int fastest);

    /// The pose `still`, swayed as at a time [s]. O(n).
    Pose swayed(const Pose& still, double time) const;

  private:
    /// An axis, from the joint that it leaves from to its tip.
    struct Axis {
        Vec3d place;        ///< [m] of its middle
        double lean = 0;    ///< [rad] of its tip in the mean wind
        double swings = 1;  ///< in a period
        double phase = 0;   ///< [rad]
        double across = 0;  ///< of its swing, beside the wind
    };
    Vec3d bend(const Axis& axis, Vec3d way, double time) const;
    double gust(Vec3d place, double time) const;

    WindOptions options_;
    double period_;
    Vec3d blow_, beside_;
    std::vector<NodeId> parent_;
    std::vector<std::uint32_t> axis_of_;  ///< by node
    std::vector<NodeId> tip_of_;          ///< by axis
    std::vector<NodeId> joint_of_;        ///< by axis; the root for that of a root
    std::vector<float> slope_;            ///< by node: part of the tip's angle that its segment has
    std::vector<Axis> axes_;
};

}  // namespace coppice
