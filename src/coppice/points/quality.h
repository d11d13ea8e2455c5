#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "coppice/base/box.h"
#include "coppice/base/context.h"
#include "coppice/base/fields.h"
#include "coppice/points/point_set.h"

namespace coppice {

/// Options of `quality`.
struct QualityOptions {
    int bins = 64;            ///< number of bins of the curves
    float range = 5;          ///< range of the curves, in mean spacings and in multiples of their frequency
    int directions = 64;      ///< number of directions over which the power is averaged
    int max_points = 100000;  ///< maximum number of points; the curves of larger sets use a random subset
};

/// Lists the members for front ends.
void list_fields(QualityOptions& o, FieldList& list);

/// Measures of the distribution of a set of points. For independent points both curves are about 1
/// everywhere.
struct QualityReport {
    std::uint64_t points = 0;  ///< number of points
    double min_distance = 0;   ///< [m] minimum distance between any two points, exact; 0 for fewer than two
    double mean_distance = 0;  ///< [m] mean distance from a point to its closest other point
    double mean_spacing = 0;   ///< [m] cube root of the volume of the window per point in it
    std::vector<double> distribution;  ///< radial: number of pairs relative to independent points
    double distance_step = 0;          ///< [m] width of a bin of `distribution`, the first from 0
    std::vector<double> power;         ///< radially averaged spectrum
    double frequency_step = 0;         ///< [1/m] between values of `power`, the first at one step
    double low_power = 0;  ///< mean power below half the frequency of the mean spacing: 1 for independent
                           ///< points, near 0 for evenly spaced ones, above 1 for clusters
    friend bool operator==(const QualityReport&, const QualityReport&) = default;  ///< compares all members
};

/// Measures the distribution of a set. The curves use the points in `window` (relative to the origin), which
/// the set should fill evenly; by default the middle half of its box along each axis. The spectrum is
/// weighted smoothly towards the sides of the window, and the contribution of a uniform density is
/// subtracted. Distances are exact, in O(n log n); the curves cost O(n bins directions). Throws InvalidInput
/// for options out of range and positions that are not finite.
QualityReport quality(const PointSet& points, const QualityOptions& options = {}, const Context& ctx = {});
/// Measures the distribution within a window, for points that are part of a larger set.
QualityReport quality(const PointSet& points, const Box3& window, const QualityOptions& options = {},
                      const Context& ctx = {});

/// Returns a plot of both curves as the text of an SVG file.
std::string quality_svg(const QualityReport& report);

}  // namespace coppice
