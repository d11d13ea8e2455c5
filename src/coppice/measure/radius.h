#pragma once

#include "coppice/base/context.h"
#include "coppice/measure/capsule_tree.h"
#include "coppice/measure/vertex_places.h"
#include "coppice/mesh/mesh.h"
#include "coppice/mesh/statistics.h"
#include "coppice/skeleton/skeleton.h"

namespace coppice {

/// Deviation of a surface from the radii of its skeleton. Deviations are rho - 1, where rho is the smallest
/// ratio of the distance to a segment and the segment's radius there.
struct RadiusReport {
    Statistics all;      ///< deviation of every used vertex
    Statistics regular;  ///< of the regular vertices: see VertexPlaces
    /// Deviation of points distributed evenly over the area of the faces; chords reduce it if the vertices
    /// are on the radius. As many points as vertices, at least 10,000.
    Statistics areas;
    friend bool operator==(const RadiusReport&, const RadiusReport&) = default;  ///< member by member
};

/// Computes the deviations. `places` must be computed from the mesh and the skeleton of `capsules`. O(n log
/// m), n vertices and m segments.
RadiusReport radius_deviation(const PolygonMesh& mesh, const CapsuleTree& capsules,
                              const VertexPlaces& places, const Context& ctx = {});

/// Returns per vertex the distance to the nearest segment divided by its radius there, minus one: negative
/// inside. NaN if the skeleton has no segment. The skeleton may have another origin. O(n log m).
std::vector<float> vertex_deviations(const PolygonMesh& mesh, const Skeleton& skeleton,
                                     const Context& ctx = {});

}  // namespace coppice
