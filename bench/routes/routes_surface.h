#pragma once

#include <cstdint>

#include "coppice/base/context.h"
#include "coppice/implicit/polygonize/polygonize.h"
#include "coppice/measure/surface_report.h"
#include "coppice/mesh/mesh.h"
#include "coppice/skeleton/skeleton.h"

namespace coppice::bench {

/// Figures of the thickest or the thinnest tenth of the segments.
struct PartFigures {
    double radius = 0;            ///< [m] mean of those segments
    double faces_per_radius = 0;  ///< number of faces on a section of branch as long as its radius
    double edge = 0;              ///< [radii] median length of the faces' edges; 0 without faces
};

/// Figures of a surface relative to its skeleton.
struct SurfaceFigures {
    std::uint64_t vertices = 0;
    SurfaceReport report;
    double min_angle = 0;  ///< [degrees] one face in a hundred has a corner below this
    Statistics edge;       ///< [radii] length of edges over the radius of the segment closest to their face
    PartFigures thick, thin;

    std::uint64_t faces() const { return report.topology.faces; }
    /// of all components together; the surface must be watertight
    std::int64_t handles() const {
        return static_cast<std::int64_t>(report.topology.components) - report.topology.euler / 2;
    }
    bool shows_all() const { return report.axes->missing == 0 && report.axes->severed == 0; }
};

/// Evaluates a surface. For more than a million faces, angles and edges are those of an evenly distributed
/// sample.
SurfaceFigures compute_figures(const PolygonMesh& mesh, const Skeleton& skeleton, const Context& ctx);

}  // namespace coppice::bench
