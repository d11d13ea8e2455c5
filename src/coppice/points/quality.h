#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "coppice/base/box.h"
#include "coppice/base/context.h"
#include "coppice/base/fields.h"
#include "coppice/points/point_set.h"

namespace coppice {

/// How the curves of a report are made.
struct QualityOptions {
    int bins = 64;        ///< of the curves
    float range = 5;      ///< curves reach to this many mean spacings, and to as many times their frequency
    int directions = 64;  ///< over which the power of a frequency is averaged
    int most_points = 100000;  ///< curves of larger sets are those of a random part of them
};

template <class Self, class Visitor>
requires SameOptions<Self, QualityOptions>
constexpr void visit_fields(Self& o, Visitor&& visit) {
    visit(Field{"bins", "bins of the curves", Unit::none, 8, 1024}, o.bins);
    visit(Field{"range", "reach of the curves in mean spacings and their frequency", Unit::none, 1, 16},
          o.range);
    visit(Field{"directions", "directions over which power is averaged", Unit::none, 8, 4096}, o.directions);
    visit(Field{"most_points", "curves of larger sets are those of a random part", Unit::none, 100, 1e6},
          o.most_points);
}

/// How the points of a set lie among each other. For independent points both curves are about 1 everywhere.
struct QualityReport {
    std::uint64_t points = 0;          ///< number of points
    double least_distance = 0;         ///< [m] between any two points, exact; 0 for fewer than two
    double mean_distance = 0;          ///< [m] from a point to its nearest
    double mean_spacing = 0;           ///< [m] cube root of the window's volume for each point in it
    std::vector<double> distribution;  ///< radial: pairs at a distance over those of independent points
    double distance_step = 0;          ///< [m] width of a bin of `distribution`, the first from 0
    std::vector<double> power;         ///< radially averaged spectrum
    double frequency_step = 0;         ///< [1/m] between values of `power`, the first at one step
    double low_power = 0;  ///< mean power below half the frequency of the mean spacing: 1 for independent
                           ///< points, near 0 for even ones, above 1 for clusters
    friend bool operator==(const QualityReport&, const QualityReport&) = default;  ///< member by member
};

/// Measures a set. The curves are those of the points in `window` (relative to the origin), which the set
/// should fill evenly; by default the middle half of its box along each axis. The spectrum is weighted
/// smoothly to the window's sides, and what an even density there would give is taken out. Distances are
/// exact, in O(n log n); the curves cost O(n bins directions). Throws InvalidInput for options out of range
/// and positions that are not finite.
QualityReport quality(const PointSet& points, const QualityOptions& options = {}, const Context& ctx = {});
/// The same within a window, for points that are part of a larger set.
QualityReport quality(const PointSet& points, const Box3& window, const QualityOptions& options = {},
                      const Context& ctx = {});

/// Both curves as a picture: the text of an SVG file.
std::string quality_svg(const QualityReport& report);

}  // namespace coppice
