#pragma once

#include <array>
#include <string_view>

#include "coppice/base/context.h"
#include "coppice/base/fields.h"
#include "coppice/mesh/mesh.h"
#include "coppice/points/point_set.h"

namespace coppice {

/// Where points on a surface lie.
enum class ScanPattern {
    scanner,  ///< beams from where a scanner stands: dense nearby, and nothing behind what hides it
    uniform   ///< in proportion to the area, hidden or not
};

template <>
struct EnumNames<ScanPattern> {
    static constexpr std::array<std::string_view, 2> names{"scanner", "uniform"};
};

/// How a surface is scanned. The scanners stand around the middle of its box, evenly, and look at all of it.
struct ScanOptions {
    ScanPattern pattern = ScanPattern::scanner;  ///< as a scanner sees it, or even
    int points = 100'000;  ///< so many, and within a few per cent of that as a scanner sees them
    int positions = 4;     ///< of the scanner
    float distance = 10;   ///< [m] from a scanner to the vertical axis through the middle of the box; > 0
    float height = 1.5f;   ///< [m] of the scanners above the lowest point
    float azimuth = 0;     ///< [rad] from the middle to the first scanner, counter-clockwise from +x
    float noise = 0.001f;  ///< [m] standard deviation: of the range along the beam, or of each coordinate
    int seed = 0;          ///< another seed gives other noise and other beams
};

template <class Self, class Visitor>
requires SameOptions<Self, ScanOptions>
constexpr void visit_fields(Self& o, Visitor&& visit) {
    visit(common_field(
              "pattern",
              "Distribution of the points: as a laser scanner measures them, or uniform on the surface"),
          o.pattern);
    visit(common_field("points", "Approximate number of points", Unit::none, 1, 1e8), o.points);
    visit(common_field("positions", "Number of scanner positions, evenly spaced around the object",
                       Unit::none, 1, 1000),
          o.positions);
    visit(common_field("distance",
                       "Distance of the scanner from the vertical axis through the centre of the object",
                       Unit::metre, 1e-3, 1e6),
          o.distance);
    visit(Field{"height", "of the scanner above the lowest point", Unit::metre, -1e6, 1e6}, o.height);
    visit(Field{"azimuth", "where the first scanner stands, counter-clockwise from +x seen from above",
                Unit::radian, -6.2832, 6.2832},
          o.azimuth);
    visit(common_field(
              "noise",
              "Standard deviation of the measured range, or of each coordinate for the uniform pattern",
              Unit::metre, 0, 1e3),
          o.noise);
    visit(common_field("seed", "Seed of the noise and of the beam directions", Unit::none, 0, 2147483647),
          o.seed);
}

/// Points on a surface as a terrestrial laser scanner sees them. Each position sends beams at equal steps of
/// azimuth and elevation through the window that holds all of the surface; a beam ends at the first face it
/// meets, from whichever side, and its range carries Gaussian noise. The step is the same for all positions,
/// so that the density falls with the square of the distance; it is chosen from a coarse scan such that about
/// as many beams as asked for meet the surface. Points come position by position, row by row; their origin is
/// that of the mesh.
///
/// The same bits for any number of threads. O(faces log faces + beams log faces); memory about 150 bytes per
/// triangle and 30 per point. Throws InvalidInput: options out of range, no face with an area, positions that
/// are not finite, or so little to be seen of the surface that more than 10 million beams and a thousand for
/// each point would be needed; Cancelled.
PointSet scan(const PolygonMesh& mesh, const ScanOptions& options = {}, const Context& ctx = {});

}  // namespace coppice
