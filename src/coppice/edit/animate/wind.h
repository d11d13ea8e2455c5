#pragma once

#include <cstdint>
#include <vector>

#include "coppice/base/fields.h"
#include "coppice/edit/animate/pose.h"
#include "coppice/skeleton/skeleton.h"

namespace coppice {

/// Parameters of the wind that moves trees.
struct WindOptions {
    float speed = 0;        ///< [m/s] mean speed; 0 = calm; in [0, 60]
    float azimuth = 0;      ///< [rad] direction in which it blows, counter-clockwise from +x seen from above
    float gusts = 0.5f;     ///< amplitude of the gusts as a fraction of the mean speed; in [0, 1]
    float flexibility = 1;  ///< factor on the bending of green wood with the given radii; in [0, 1000]
    float load = 12;  ///< ratio of the width that catches the wind, including leaves and twigs, to the width
                      ///< of the branch; in [0, 1000]
    int seed = 0;     ///< seed of gusts and phases; in [0, 2^31 - 1]
};

/// Lists the members for front ends.
void list_fields(WindOptions& o, FieldList& list);

/// Periodic motion of a forest in the wind. Each axis is a cantilever on its parent axis, moves with it, is
/// bent by the wind pressure on itself and on its load, and oscillates at its own frequency. Gusts travel
/// with the wind, so that trees downwind sway later. The deflection of each axis stays below about 50
/// degrees.
///
/// Deterministic: the phase of an axis depends on its number and the seed.
class Wind {
  public:
    /// `period` [s] is the time after which the motion repeats; `fastest` is the maximum number of
    /// oscillations per period. Throws InvalidInput if an option is out of range or the period is not
    /// positive. O(n).
    Wind(const Skeleton& rest, const WindOptions& options, double period, int fastest);

    /// Returns the pose `still` deflected by the wind at a time [s]. O(n).
    Pose swayed(const Pose& still, double time) const;

  private:
    /// An axis from its joint with the parent axis to its tip.
    struct Axis {
        Vec3d place;        ///< [m] midpoint
        double lean = 0;    ///< [rad] deflection of its tip in the mean wind
        double swings = 1;  ///< oscillations per period
        double phase = 0;   ///< [rad]
        double across = 0;  ///< relative amplitude of the oscillation perpendicular to the wind
    };
    Vec3d bend(const Axis& axis, Vec3d way, double time) const;
    double gust(Vec3d place, double time) const;

    WindOptions options_;
    double period_;
    Vec3d blow_, across_;
    std::vector<NodeId> parent_;
    std::vector<std::uint32_t> axis_of_;  ///< by node
    std::vector<NodeId> tip_of_;          ///< by axis
    std::vector<NodeId> joint_of_;        ///< by axis; the root for the axis of a root
    std::vector<float> slope_;  ///< by node: fraction of the deflection of the tip that its segment has
    std::vector<Axis> axes_;
};

}  // namespace coppice
