#pragma once

#include "coppice/implicit/shape/profile.h"

namespace coppice {

/// An axis of rotation in space.
struct Axis {
    Vec3 origin{};            ///< [m] a point on the axis
    Vec3 direction{0, 0, 1};  ///< of any length except zero
};

/// A profile rotated about an axis: x of the profile is the distance from the axis, y is the position along
/// it from the origin. An open profile is closed by flat discs from its ends to the axis; a closed one makes
/// a ring. Distances are exact.
class Revolution final : public Shape {
  public:
    /// Throws InvalidInput if the profile has an x below 0, all its points are on the axis or at one height,
    /// or the axis is not finite or has no direction.
    explicit Revolution(const Profile& profile, const Axis& axis = {});

    Box3 bounds() const override { return bounds_; }
    void distance(std::span<const Vec3> points, std::span<FieldSample> out) const override;
    bool is_closed() const override { return true; }

  private:
    Vec3d origin_, direction_;
    ContourIndex index_;
    Box3 bounds_;
};

}  // namespace coppice
