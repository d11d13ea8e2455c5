#pragma once

#include <array>
#include <string_view>
#include <vector>

#include "coppice/base/fields.h"

namespace coppice {

/// Density of points as a function of the value of a field with the surface value = level.
enum class PointDensity {
    uniform,          ///< constant inside
    proportional,     ///< inside, proportional to the value: dense in the middle
    inverse,          ///< inside, proportional to the reciprocal of the value: dense near the surface
    inside_boundary,  ///< in the shell level < value < level + width
    outside_boundary  ///< in the shell level - width < value < level
};

template <>
struct EnumNames<PointDensity> {
    static constexpr std::array<std::string_view, 5> names{"uniform", "proportional", "inverse",
                                                           "inside_boundary", "outside_boundary"};
};

/// Density of points as a function of the value of a field: never negative; only its shape matters, not its
/// scale. The density of NaN is 0.
class DensityCurve {
  public:
    /// Vertex of a piecewise linear curve.
    struct Knot {
        float value;    ///< value of the field
        float density;  ///< relative, 0 to 1e6
    };

    /// Creates a density of one of the kinds above. `width` (of the shells, in units of the value) is above 0
    /// and finite. `power`, 0 to 16, is the exponent of `proportional` and `inverse`, which need a level
    /// above 0. Throws InvalidInput.
    DensityCurve(PointDensity kind, float level, float width = 0.1f, float power = 1);

    /// Creates a piecewise linear density, 0 before the first knot and after the last; values must not
    /// decrease, and two knots with the same value define a step. Throws InvalidInput for fewer than two
    /// knots, decreasing values, negative densities, numbers that are not finite, and if no density is above
    /// 0.
    explicit DensityCurve(std::vector<Knot> knots);

    /// Returns the density at a value of the field.
    double at(float value) const;

    /// Minimum and maximum density of a range of values.
    struct Range {
        double least;    ///< lower bound
        double largest;  ///< upper bound
    };
    /// Returns bounds of the density for values from low to high.
    Range over(float low, float high) const;

    /// Returns the width of the range of values with a density above 0: of a shell, or of knots; 0 if the
    /// range is unbounded.
    float shell_width() const { return shell_width_; }

  private:
    double inside(float value) const;

    float low_, high_;  ///< the density is 0 outside; the bounds are included if closed_
    bool closed_ = false;
    float shell_width_ = 0;
    double scale_ = 1, exponent_ = 0;
    std::vector<Knot> knots_;
};

}  // namespace coppice
