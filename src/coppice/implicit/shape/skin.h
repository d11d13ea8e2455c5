#pragma once

#include <array>
#include <string_view>
#include <vector>

#include "coppice/implicit/shape/profile.h"

namespace coppice {

/// How the distance fields of sections go over into each other. All surfaces pass through every section.
enum class SkinBlend {
    linear,     ///< straight from section to section
    quadratic,  ///< two parabolas: leaves every section along the path, without a crease
    cubic,      ///< the cubic B-spline over sections taken three times each: stays longer with them
    smooth      ///< cubic through four sections in a row: flows through sections; may swing beyond them
};

template <>
struct EnumNames<SkinBlend> {
    static constexpr std::array<std::string_view, 4> names{"linear", "quadratic", "cubic", "smooth"};
};

/// How sections go over into each other.
struct SkinOptions {
    SkinBlend blend = SkinBlend::linear;  ///< how smoothly
    float roll = 0;                       ///< [rad] turns all sections about the path; right-handed
    float twist =
        0;  ///< [rad] turns them on, evenly over the length; whole turns only when the path is closed
};

template <class Self, class Visitor>
requires SameOptions<Self, SkinOptions>
constexpr void visit_fields(Self& o, Visitor&& visit) {
    visit(Field{"blend", "how sections go over into each other"}, o.blend);
    visit(Field{"roll", "angle by which the sections are turned about the path", Unit::radian, -1e3, 1e3},
          o.roll);
    visit(Field{"twist", "angle by which they turn on from the path's start to its end", Unit::radian, -1e3,
                1e3},
          o.twist);
}

/// A closed profile tied to a place of the path. It may have several contours; sections at one place are
/// united, such as the four legs of a table whose top is one section at the other end.
struct SkinSection {
    float fraction = 0;  ///< of the path's length, in [0, 1]
    Profile profile;     ///< closed
};

/// The surface through planar sections along a path: at a point, the plane across the path's nearest place
/// gives the point's coordinates in every section (x along the normal of the curve's frame, y along the
/// binormal), and the distances to the neighbouring sections are blended by their place along the path. So
/// sections need not match in shape or in number of contours.
///
/// Before the first section and after the last the nearest one goes on; open paths end in flat caps; on a
/// closed path the last section goes over into the first. Where several places of a winding path have the
/// point in their plane, the least distance counts. The value is a blend of distances: its gradient is exact,
/// and longer than 1 where sections change fast along the path.
class Skin final : public Shape {
  public:
    /// Throws InvalidInput when there is no section or one is open, for fractions and options out of range,
    /// and for a polyline that turns back on itself.
    Skin(Curve path, std::vector<SkinSection> sections, const SkinOptions& options = {});

    Box3 bounds() const override { return bounds_; }
    void distance(std::span<const Vec3> points, std::span<FieldSample> out) const override;
    bool is_closed() const override { return true; }
    /// Not a true distance everywhere: no bound is known.
    float steepness() const override { return Box3::kInfinity; }

    std::size_t station_count() const { return station_fraction_.size(); }  ///< places that have sections

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
