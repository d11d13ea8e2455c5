#pragma once

#include <cstdint>
#include <optional>
#include <vector>

#include "coppice/base/context.h"
#include "coppice/base/vec.h"
#include "coppice/points/point_set.h"
#include "coppice/skeleton/skeleton.h"

namespace coppice {

/// [m] height above the ground at which foresters measure the diameter of a stem.
inline constexpr double kBreastHeight = 1.3;

/// [standard deviation] half-width of the 90 % interval of a normal distribution.
inline constexpr double kNineOfTen = 1.645;

/// Diameter and its uncertainty.
struct StemDiameter {
    double height = 0;     ///< [m] above the ground
    double diameter = 0;   ///< [m] 0 if unknown
    double deviation = 0;  ///< [m] standard deviation of the diameter; 0 if unknown
    double residual = 0;   ///< [m] root mean square distance of the points from the circle
    double coverage = 0;   ///< share of the circumference with points, in [0, 1]
    Vec3d center;          ///< [m] centre of the stem at this height, in the coordinate frame of the file

    /// Returns the lower bound [m] of the 90 % interval of the diameter, from its deviation and a standard
    /// deviation of 2.5 % for the model, as measured on simulated scans.
    double low() const;
    double high() const;  ///< Returns the upper bound [m]; see low().
};

/// Forestry measurements of a tree.
struct StemForm {
    Vec3d foot;              ///< [m] intersection of the axis of the stem with the ground
    bool on_ground = false;  ///< whether there are ground points; otherwise the foot is the lowest end
    double height = 0;       ///< [m] from the foot to the highest point
    double height_low = 0;   ///< [m] lower bound of the 90 % interval of the height; 0 if unknown
    double height_high = 0;  ///< [m] upper bound of this interval, without outliers; 0 if unknown
    StemDiameter breast;     ///< at 1.3 m
    std::vector<StemDiameter> taper;  ///< upward, as far as the stem could be traced
    std::uint32_t stems = 0;          ///< number of stems detected at breast height, including this one
};

/// Returns the half-width [m] of the 90 % interval of the height of a tree on simulated scans: two spacings
/// of the points plus two centimetres.
double height_margin(double spacing);

/// Measures the form of the stem of a tree from its points, with or without ground.
///
/// The ground is found by find_terrain; without ground, the lowest end of the stem is its foot. Circles in
/// slices from 0.3 to 4 m above it that form a stack are stems; the one with the best coverage is used. Its
/// diameter at breast height is that of a straight line through the radii of thirteen slices from 0.85
/// to 1.75 m, each across the axis; slices along the complete axis determine the taper. Outliers, twigs and
/// leaves near a stem have no influence as long as a quarter of its circumference is visible; stems thinner
/// than two spacings are not measured. Without a stem `breast.diameter` and `stems` are 0.
///
/// O(n log n), about 60 bytes per point. Throws InvalidInput for fewer than 20 points; Cancelled.
StemForm stem_form(const PointSet& points, const Context& ctx = {});

/// Measures the stems in a horizontal slice of a plot, thickest first, for clouds that were cut at breast
/// height. Detects clear circles in plan view, with at least 30 points and 0.4 of their circumference, in
/// points that rise at most 1 m and at most half as much as they extend. Their height and the height of the
/// slice above the ground are unknown: `height` is 0, and `breast` is the diameter in the slice, at the
/// `foot`, which is the centre at the lower side of the slice. Empty for all other points.
///
/// O(n log n). Throws Cancelled.
std::vector<StemForm> slice_forms(const PointSet& points, const Context& ctx = {});

/// Returns the stem form of each root of a skeleton: diameters are those of the nodes along the axis that
/// leads highest, through children at least 0.4 times as thick as the thickest one; at breast height their
/// mean from 1.1 to 1.5 m above the root. Deviations, residuals and coverage are 0. O(n).
std::vector<StemForm> stem_forms(const Skeleton& skeleton);

/// Returns the stem alone, from its foot as far as there are sections, with positions and radii from robust
/// local lines and radii that do not increase upward. Its origin is the foot. Returns nullopt for fewer than
/// four sections. O(sections).
std::optional<Skeleton> stem_skeleton(const StemForm& form);

}  // namespace coppice
