#pragma once

#include <cstdint>
#include <optional>

#include "coppice/base/context.h"
#include "coppice/mesh/half_edges.h"
#include "coppice/mesh/mesh.h"
#include "coppice/mesh/statistics.h"
#include "coppice/skeleton/skeleton.h"

namespace coppice {

/// Deviation of a surface, or of a portion of it, from a flat one.
struct Smoothness {
    /// The integral of the squared principal curvatures, computed from the gradient of the vertex normals
    /// (area-weighted means of the normals of adjacent faces) along the faces, each a fan of triangles.
    /// Dimensionless: it is invariant to scaling, and hardly changes when smooth faces are subdivided. A
    /// sphere has 8 pi, a tube 2 pi per radius of its length; a sharp crease has more if the faces are finer.
    /// Tubes that intersect without a common edge do not contribute.
    double bending = 0;
    Statistics face_angle;  ///< [degrees] between the normals of two faces at an edge; 0 is flat
    friend bool operator==(const Smoothness&, const Smoothness&) = default;  ///< member by member
};

/// The smoothness of a surface, and of its forks.
struct SmoothnessReport {
    Smoothness whole;                 ///< of all faces
    std::optional<Smoothness> forks;  ///< of faces with centroids within two radii of the nodes with at least
                                      ///< three neighbours; nullopt without a skeleton
    std::optional<Smoothness> chains;  ///< of the other faces; nullopt without a skeleton
    friend bool operator==(const SmoothnessReport&, const SmoothnessReport&) = default;  ///< member by member
};

/// Evaluates a valid mesh; `skeleton`, which may be null, provides the forks, and may have another origin.
/// Faces without area, and edges without exactly two faces, are ignored. O(n log m) [n faces, m forks]. The
/// result does not depend on the number of threads.
SmoothnessReport smoothness(const PolygonMesh& mesh, const Skeleton* skeleton, const Context& ctx = {});
/// The same for given half-edges of the mesh.
SmoothnessReport smoothness(const PolygonMesh& mesh, const HalfEdges& edges, const Skeleton* skeleton,
                            const Context& ctx = {});

}  // namespace coppice
