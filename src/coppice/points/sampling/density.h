#pragma once

#include <array>
#include <string_view>
#include <vector>

#include "coppice/base/fields.h"

namespace coppice {

/// How the density of points follows from the value of a field whose surface is value = level.
enum class PointDensity {
    uniform,          ///< the same everywhere inside
    proportional,     ///< inside, as the value: dense in the middle
    inverse,          ///< inside, as its reciprocal: dense near the surface
    inside_boundary,  ///< in the shell level < value < level + width
    outside_boundary  ///< in the shell level - width < value < level
};

template <>
struct EnumNames<PointDensity> {
    static constexpr std::array<std::string_view, 5> names{"uniform", "proportional", "inverse",
                                                           "inside_boundary", "outside_boundary"};
};

/// A density of points as a function of a field's value: never negative, only its shape matters, not its
/// scale. Values that are not a number have density 0.
class DensityCurve {
  public:
    /// A corner of a curve.
    struct Knot {
        float value;    ///< of the field
        float density;  ///< relative, 0 to 1e6
    };

    /// Densities of the kinds above. `width` (of the shells, in units of the value) is above 0 and finite.
    /// `power` 0 to 16 is the exponent of `proportional` and `inverse`, which need a level above 0. Throws
    /// InvalidInput.
    DensityCurve(PointDensity kind, float level, float width = 0.1f, float power = 1);

    /// Linear between knots, 0 before the first and behind the last; values must not fall, and two knots of
    /// one value make a step. Throws InvalidInput for fewer than two knots, falling values, negative
    /// densities, numbers that are not finite, and where no density is above 0.
    explicit DensityCurve(std::vector<Knot> knots);

    /// The density where the field has this value.
    double at(float value) const;

    /// The greatest and the least density of values from low to high.
    struct Range {
        double least;     ///< no density is less
        double greatest;  ///< no density is greater
    };
    /// The bounds of the density for values from low to high.
    Range over(float low, float high) const;

    /// The range of values with a density above 0: of a shell, or of knots; 0 where it has no end.
    float shell_width() const { return shell_width_; }

  private:
    double inside(float value) const;

    float low_, high_;  ///< the density is 0 outside; the ends themselves belong to it where closed_
    bool closed_ = false;
    float shell_width_ = 0;
    double scale_ = 1, exponent_ = 0;
    std::vector<Knot> knots_;
};

}  // namespace coppice
