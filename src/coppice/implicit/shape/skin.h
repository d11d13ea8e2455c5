#pragma once

#include <array>
#include <string_view>
#include <vector>

#include "coppice/implicit/shape/profile.h"

namespace coppice {

/// Interpolation of the distance fields of sections. All surfaces pass through every section.
enum class SkinBlend {
    linear,     ///< linear between sections
    quadratic,  ///< two parabolas: starts from every section along the path, without a crease
    cubic,      ///< cubic B-spline over triple sections: stays close to them longer
    smooth      ///< cubic through four consecutive sections: smooth at sections; may overshoot them
};

template <>
struct EnumNames<SkinBlend> {
    static constexpr std::array<std::string_view, 4> names{"linear", "quadratic", "cubic", "smooth"};
};

/// Options of Skin.
struct SkinOptions {
    SkinBlend blend = SkinBlend::linear;  ///< interpolation between sections
    float roll = 0;                       ///< [rad] rotates all sections about the path; right-handed
    float twist = 0;  ///< [rad] additional rotation, distributed evenly over the length; only whole turns if
                      ///< the path is closed
};

/// Lists the members for front ends.
void list_fields(SkinOptions& o, FieldList& list);

/// A closed profile at a place of the path. It may have several contours; sections at one place are united,
/// for example the four legs of a table with a top that is one section at the other end.
struct SkinSection {
    float fraction = 0;  ///< of the path's length, in [0, 1]
    Profile profile;     ///< closed
};

/// The surface through planar sections along a path: for a point, the plane perpendicular to the nearest
/// place of the path defines the point's coordinates in every section (x along the normal of the curve's
/// frame, y along the binormal), and the distances to the neighbouring sections are interpolated by their
/// place along the path. So sections need not match in shape or in number of contours.
///
/// Before the first section and after the last the nearest one continues; open paths end in flat caps; on a
/// closed path the last section is interpolated with the first. If the perpendicular planes of several places
/// of a winding path contain the point, the smallest distance is used. The value is a blend of distances: its
/// gradient is exact, and longer than 1 where sections change fast along the path.
class Skin final : public Shape {
  public:
    /// Throws InvalidInput if there is no section or one is open, for fractions and options out of range, and
    /// for a polyline that turns back on itself.
    Skin(Curve path, std::vector<SkinSection> sections, const SkinOptions& options = {});

    Box3 bounds() const override { return bounds_; }
    void distance(std::span<const Vec3> points, std::span<FieldSample> out) const override;
    bool is_closed() const override { return true; }
    /// Not a true distance everywhere: no bound is known.
    float steepness() const override { return Box3::kInfinity; }

    /// Number of places with sections.
    std::size_t station_count() const { return station_fraction_.size(); }

  private:
    struct Weights;
    Weights weights(double fraction) const;
    PlaneSample station(std::size_t i, Vec2d p) const;

    Curve path_;
    std::vector<SkinSection> sections_;  ///< by place
    std::vector<double> station_fraction_;
    std::vector<std::size_t> station_first_;  ///< of the sections, and one more
    SkinOptions options_;
    double reach_ = 0;
    Box3 bounds_;
};

}  // namespace coppice
