#pragma once

#include <array>
#include <string_view>

#include "coppice/base/context.h"
#include "coppice/base/fields.h"
#include "coppice/mesh/mesh.h"
#include "coppice/points/point_set.h"

namespace coppice {

/// Distribution of points on a surface.
enum class ScanPattern {
    scanner,  ///< beams from a scanner: dense nearby, and none on hidden surfaces
    uniform   ///< proportional to the area, hidden or not
};

template <>
struct EnumNames<ScanPattern> {
    static constexpr std::array<std::string_view, 2> names{"scanner", "uniform"};
};

/// Options of a scan. The scanners are evenly spaced around the centre of the bounding box, and cover all of
/// it.
struct ScanOptions {
    ScanPattern pattern = ScanPattern::scanner;  ///< distribution of the points
    int points = 100'000;  ///< number of points, for the scanner pattern within a few per cent
    int positions = 4;     ///< number of positions of the scanner
    float distance = 10;   ///< [m] from a scanner to the vertical axis through the centre of the box; > 0
    float height = 1.5f;   ///< [m] of the scanners above the lowest point
    float azimuth = 0;     ///< [rad] from the centre to the first scanner, counter-clockwise from +x
    float noise = 0.001f;  ///< [m] standard deviation of the range along the beam, or of each coordinate
    int seed = 0;          ///< of the noise and of the beam directions
};

/// Lists the members for front ends.
void list_fields(ScanOptions& o, FieldList& list);

/// Returns points on a surface as measured by a terrestrial laser scanner. Each position sends beams at equal
/// steps of azimuth and elevation through the window that contains the whole surface; a beam ends at the
/// first face that it meets from either side, and its range has Gaussian noise. The step is the same for all
/// positions, so that the density decreases with the square of the distance; it is chosen by a coarse scan
/// such that approximately the requested number of beams meets the surface. The points are ordered by
/// position and row; their origin is that of the mesh.
///
/// The result does not depend on the number of threads. O(faces log faces + beams log faces); memory about
/// 150 bytes per triangle and 30 per point. Throws InvalidInput for options out of range, a mesh without
/// area, positions that are not finite, or a surface so little visible that more than 10 million beams and a
/// thousand for each point would be needed; Cancelled.
PointSet scan(const PolygonMesh& mesh, const ScanOptions& options = {}, const Context& ctx = {});

}  // namespace coppice
