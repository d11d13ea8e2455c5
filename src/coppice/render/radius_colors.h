#pragma once

#include <vector>

#include "coppice/base/context.h"
#include "coppice/mesh/mesh.h"
#include "coppice/points/point_cloud.h"
#include "coppice/skeleton/skeleton.h"

namespace coppice {

/// Colours of radii on a logarithmic scale: blue for the smallest, red for the largest.
struct RadiusColors {
    float min = 0;              ///< [m] smallest radius of the nodes
    float max = 0;              ///< [m] largest radius of the nodes
    std::vector<Rgb> nodes;     ///< per node of the skeleton
    std::vector<Rgb> vertices;  ///< per vertex of the mesh: radius of the closest segment; empty without mesh
};

/// Returns the colours of a skeleton and of a mesh, which may be null and may have another origin. O((m + n)
/// log m), m nodes and n vertices.
RadiusColors radius_colors(const Skeleton& skeleton, const PolygonMesh* mesh, const Context& ctx = {});

}  // namespace coppice
