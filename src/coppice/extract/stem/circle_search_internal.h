#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "coppice/extract/tree/circle_fit_internal.h"

namespace coppice::extract_internal {

/// Circle in points of which some belong to twigs, leaves or other stems.
struct FoundCircle {
    double x = 0, y = 0, radius = 0;  ///< [m]
    double residual = 0;              ///< [m] root mean square distance of the points on it
    double deviation = 0;             ///< [m] standard deviation of the radius
    double coverage = 0;              ///< share of its circumference with points
    double inside = 0;                ///< number of points well inside of it, per point on it
    std::uint32_t used = 0;           ///< number of points on it; 0 if no circle was found
};

/// Search region and parameters of `find_circle`.
struct CircleSearch {
    double min_radius = 0.01, max_radius = 1;  ///< [m]
    double noise = 0.005;    ///< [m] approximate distance of points from the surface of a stem
    std::uint64_t seed = 0;  ///< seed of the random draws
    bool anywhere = true;    ///< if false, accepts only circles with a centre within `reach` of (`x`, `y`)
    double x = 0, y = 0, reach = 0;  ///< [m]
};

/// Finds the circle with the largest share of its circumference covered by points and the fewest points
/// inside: draws circles through three nearby points, as in [Fischler1981], and fits the best one to the
/// points near it (see fit_circle). Does not find arcs of less than about a quarter. O(draws * points), some
/// hundred draws.
FoundCircle find_circle(std::span<const PlanePoint> points, const CircleSearch& search);

/// Returns the radius of the circle with the area of a non-circular section, for example one with buttresses:
/// its outline consists of the closest points in each direction, between half and 1.6 times the radius of the
/// found circle. Returns that radius if fewer than four of five directions contain points. O(n log n).
double outline_radius(std::span<const PlanePoint> points, const FoundCircle& circle, double noise);

/// Returns by how much a circle explains the points within `reach` [m] of the origin better than chance: the
/// logarithm of a likelihood ratio. The plane is divided into squares with the width of the circle line; one
/// model has one share of squares with points for each of the inside, the circle and the outside, the other
/// model one share for all squares. Returns 0 if the circle does not have the largest share. Of n circles in
/// uniformly distributed points about p exceed log(n / p) [Desolneux2008]. O(n log n).
double circle_contrast(std::span<const PlanePoint> points, const FoundCircle& circle, double noise,
                       double reach);

/// Keeps only the first point of every square of this edge length [m], so that the density near the scanner
/// has no influence. Sorts the points. O(n log n).
std::vector<PlanePoint> thin_plane(std::span<const PlanePoint> points, double edge);

}  // namespace coppice::extract_internal
