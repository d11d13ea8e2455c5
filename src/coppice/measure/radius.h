#pragma once

#include "coppice/base/context.h"
#include "coppice/measure/capsule_tree.h"
#include "coppice/measure/vertex_places.h"
#include "coppice/mesh/mesh.h"
#include "coppice/mesh/statistics.h"
#include "coppice/skeleton/skeleton.h"

namespace coppice {

/// How truly a surface keeps the radii of its skeleton. Deviations are rho - 1, where rho is the least
/// distance to a segment over the segment's radius there.
struct RadiusReport {
    Statistics all;      ///< deviation of every used vertex
    Statistics regular;  ///< of the regular vertices: see VertexPlaces
    /// Deviation of points spread evenly over the area of the faces, which chords lower where vertices lie on
    /// the radius. As many as vertices, at least 10,000.
    Statistics areas;
    friend bool operator==(const RadiusReport&, const RadiusReport&) = default;  ///< member by member
};

/// `places` must be those of the mesh along the skeleton of `capsules`. O(n log m), n vertices and m
/// segments.
RadiusReport radius_deviation(const PolygonMesh& mesh, const CapsuleTree& capsules,
                              const VertexPlaces& places, const Context& ctx = {});

/// Per vertex the distance to the nearest segment over its radius there, minus one: negative inside. NaN
/// where the skeleton has no segment. The skeleton may have another origin. O(n log m).
std::vector<float> vertex_deviations(const PolygonMesh& mesh, const Skeleton& skeleton,
                                     const Context& ctx = {});

}  // namespace coppice
