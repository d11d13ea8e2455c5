#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "coppice/extract/tree/circle_fit_internal.h"

namespace coppice::extract_internal {

/// A circle amid points some of which belong to twigs, leaves or other stems.
struct FoundCircle {
    double x = 0, y = 0, radius = 0;  ///< [m]
    double residual = 0;              ///< [m] root mean square distance of the points on it
    double deviation = 0;             ///< [m] standard deviation of the radius
    double coverage = 0;              ///< share of its circumference that has points
    double inside = 0;                ///< points well inside of it, per point on it
    std::uint32_t used = 0;           ///< points on it; 0: no circle was found
};

/// Where a circle is looked for.
struct CircleSearch {
    double least_radius = 0.01, greatest_radius = 1;  ///< [m]
    double noise = 0.005;                             ///< [m] how far points lie off a stem's surface, about
    std::uint64_t seed = 0;                           ///< of the draws
    bool anywhere = true;            ///< else only circles about `x`, `y` count, within `reach` of it
    double x = 0, y = 0, reach = 0;  ///< [m]
};

/// The circle that most of whose circumference has points on it, and the fewest inside: circles through three
/// points drawn near to each other, as in [Fischler1981], the best of them fitted to the points near it (see
/// fit_circle). Arcs of less than about a quarter are not found. O(draws * points), some hundred draws.
FoundCircle find_circle(std::span<const PlanePoint> points, const CircleSearch& search);

/// The radius of the circle as large as a section that is no circle, such as one with buttresses: the nearest
/// points in each direction are its outline, within half and 1.6 times the radius of the circle found. That
/// circle's radius where there are points in less than four of five directions. O(n log n).
double outline_radius(std::span<const PlanePoint> points, const FoundCircle& circle, double noise);

/// Returns by how much a circle explains the points within `reach` [m] of the origin better than chance: the
/// logarithm of a ratio of likelihoods. The plane is divided into squares as wide as the circle is thick; one
/// model has a share of squares with points for each of the inside, the circle and the outside, the other one
/// share for all. Returns 0 where the circle does not have the largest share. Of n circles in points strewn
/// evenly about p exceed log(n / p) [Desolneux2008]. O(n log n).
double circle_contrast(std::span<const PlanePoint> points, const FoundCircle& circle, double noise,
                       double reach);

/// Keeps one point, the first, of every square of this edge [m]: what stands near the scanner has no more
/// say than the rest. Orders the points. O(n log n).
std::vector<PlanePoint> thin_plane(std::span<const PlanePoint> points, double edge);

}  // namespace coppice::extract_internal
