#pragma once

#include <span>
#include <vector>

#include "coppice/implicit/shape/profile.h"

namespace coppice {

/// Options of Sweep.
struct SweepOptions {
    float roll = 0;   ///< [rad] rotates the profile about the path by a constant angle; right-handed
    float twist = 0;  ///< [rad] additional rotation, distributed evenly over the length; only whole turns if
                      ///< the path is closed
};

/// Lists the members for front ends.
void list_fields(SweepOptions& o, FieldList& list);

/// The scale of the profile at a place of the path; linear between places, constant before and after them.
struct ScaleAt {
    float fraction = 0;  ///< of the path's length, in [0, 1]
    float scale = 1;     ///< > 0, at most 1e3
};

/// A closed profile moved along a path, perpendicular to it, in the frames of the curve: x of the profile
/// along the normal, y along the binormal. Open paths end in flat caps. Distances are exact if scale and
/// twist are constant and the path has no tight bend within reach. At outer corners of polylines the profile
/// rotates with the corner.
///
/// If the perpendicular planes of several places of a winding path contain the point, the smallest distance
/// is used: the solid is the whole volume swept by the profile.
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
    double reach_ = 0;  ///< [m] maximum distance of the surface from the path
    Box3 bounds_;
};

}  // namespace coppice
