#pragma once

#include <span>
#include <vector>

#include "coppice/implicit/shape/profile.h"

namespace coppice {

/// How the profile turns about the path.
struct SweepOptions {
    float roll = 0;   ///< [rad] turns the profile about the path, everywhere; right-handed
    float twist = 0;  ///< [rad] turns it on, evenly over the length; whole turns only when the path is closed
};

template <class Self, class Visitor>
requires SameOptions<Self, SweepOptions>
constexpr void visit_fields(Self& o, Visitor&& visit) {
    visit(Field{"roll", "angle by which the profile is turned about the path", Unit::radian, -1e3, 1e3},
          o.roll);
    visit(Field{"twist", "angle by which it turns on from the path's start to its end", Unit::radian, -1e3,
                1e3},
          o.twist);
}

/// The scale of the profile at a place of the path; linear between places, constant before and after them.
struct ScaleAt {
    float fraction = 0;  ///< of the path's length, in [0, 1]
    float scale = 1;     ///< > 0, at most 1e3
};

/// A closed profile carried along a path, across it, in the frames of the curve: x of the profile along the
/// normal, y along the binormal. Open paths end in flat caps. Distances are exact where profile and path make
/// them so: scale and twist constant, no tight bend of the path within reach. At outer corners of polylines
/// the profile turns with the corner.
///
/// Where several places of a winding path have the point in their plane, the least distance counts: the solid
/// is all that the profile sweeps over.
class Sweep final : public Shape {
  public:
    /// Throws InvalidInput for an open profile, a polyline that turns back on itself, scales out of range or
    /// out of order, and options out of range.
    Sweep(Curve path, Profile profile, std::span<const ScaleAt> scales = {},
          const SweepOptions& options = {});

    Box3 bounds() const override { return bounds_; }
    void distance(std::span<const Vec3> points, std::span<FieldSample> out) const override;
    bool is_closed() const override { return true; }
    /// Not a true distance everywhere: no bound is known.
    float steepness() const override { return Box3::kInfinity; }

  private:
    Curve path_;
    Profile profile_;
    std::vector<ScaleAt> scales_;
    SweepOptions options_;
    double reach_ = 0;  ///< [m] how far the surface may be from the path
    Box3 bounds_;
};

}  // namespace coppice
