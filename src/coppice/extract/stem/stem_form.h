#pragma once

#include <cstdint>
#include <optional>
#include <vector>

#include "coppice/base/context.h"
#include "coppice/base/vec.h"
#include "coppice/points/point_set.h"
#include "coppice/skeleton/skeleton.h"

namespace coppice {

/// [m] Above the ground, where foresters measure the diameter of a stem.
inline constexpr double kBreastHeight = 1.3;

/// [standard deviation] Nine of ten values of a normal distribution are within this of its mean.
inline constexpr double kNineOfTen = 1.645;

/// A diameter, and how sure it is.
struct StemDiameter {
    double height = 0;     ///< [m] above the ground
    double diameter = 0;   ///< [m] 0: unknown
    double deviation = 0;  ///< [m] standard deviation of the diameter; 0 where nothing tells it
    double residual = 0;   ///< [m] root mean square distance of the points from the circle
    double coverage = 0;   ///< share of the circumference that has points, in [0, 1]
    Vec3d center;          ///< [m] of the stem there, in the frame of the file

    /// [m] With high(), the bounds of the true diameter in nine of ten cases, from its deviation and a
    /// standard deviation of 2.5 % for the model, as found on simulated scans.
    double low() const;
    double high() const;  ///< [m] see low()
};

/// What forestry wants to know of a tree.
struct StemForm {
    Vec3d foot;                       ///< [m] where the axis of the stem meets the ground
    bool on_ground = false;           ///< there are points of ground; else the foot is the lowest end
    double height = 0;                ///< [m] from the foot to the highest point
    double height_low = 0;            ///< [m] with `height_high`: the true height lies between in nine of ten
    double height_high = 0;           ///< [m] scans without strays; 0 where nothing tells it
    StemDiameter breast;              ///< at 1.3 m
    std::vector<StemDiameter> taper;  ///< upward, as far as the stem could be followed
    std::uint32_t stems = 0;          ///< that were seen at breast height, this one included
};

/// [m] The height of a tree is known to this in nine of ten simulated scans: two spacings of the points, and
/// two centimetres.
double height_margin(double spacing);

/// The form of the stem of a tree from its points, ground or none under it.
///
/// Ground is looked for as find_terrain does; where there is none, the lowest end of the stem is its foot.
/// Circles in slices from 0.3 to 4 m above it, stacked, are stems; the one seen best is taken. Its diameter
/// at breast height is read off a straight line through the radii of thirteen slices from 0.85 to 1.75 m,
/// each across the axis; slices all along the axis give the taper. Strays, twigs and leaves beside a stem do
/// no harm as long as a quarter of its circumference is seen; thickness below two spacings is not measured.
/// Without a stem `breast.diameter` is 0 and `stems` too.
///
/// O(n log n), about 60 bytes per point. Throws InvalidInput for less than 20 points; Cancelled.
StemForm stem_form(const PointSet& points, const Context& ctx = {});

/// The stems of a level slice of a plot, the thickest first, as when a cloud was cut at breast height: the
/// clear circles, of at least 30 points and 0.4 of their circumference, that are seen from above in points
/// that rise no more than 1 m, and half as much as they extend. Their height and that of the slice above the
/// ground are unknown: `height` is 0, and `breast` the diameter in the slice, at the `foot`, which is the
/// centre at the lower side of the slice. Empty for all other points.
///
/// O(n log n). Throws Cancelled.
std::vector<StemForm> slice_forms(const PointSet& points, const Context& ctx = {});

/// stem_form() of a skeleton, one for each root: diameters are those of the nodes along the axis that leads
/// highest, by children at least 0.4 times as thick as the thickest one, at breast height their mean from 1.1
/// to 1.5 m above the root. Deviations, residuals and coverage are 0. O(n).
std::vector<StemForm> stem_forms(const Skeleton& skeleton);

/// The stem alone, from its foot as far as sections show it, its places and radii by local lines in which
/// sections that lie off do not count, radii never growing upward. Its origin is the foot. Nothing where
/// there are fewer than four sections. O(sections).
std::optional<Skeleton> stem_skeleton(const StemForm& form);

}  // namespace coppice
