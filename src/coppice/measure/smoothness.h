#pragma once

#include <cstdint>
#include <optional>

#include "coppice/base/context.h"
#include "coppice/measure/sides.h"
#include "coppice/mesh/mesh.h"
#include "coppice/mesh/statistics.h"
#include "coppice/skeleton/skeleton.h"

namespace coppice {

/// How far a surface, or a part of it, is from flat.
struct Smoothness {
    /// The integral of the squared principal curvatures: of how fast the normals of the vertices, which are
    /// the mean of those of the faces around by area, turn along the faces, each a fan of triangles. No unit:
    /// it stays the same when a surface is scaled, and hardly changes when smooth faces are cut into finer
    /// ones. A sphere has 8 pi, a tube 2 pi for every radius of its length; a crease that is not rounded has
    /// more the finer the faces are. Where tubes run through each other without an edge, nothing is seen.
    double bending = 0;
    Statistics face_angle;  ///< [degrees] between the normals of two faces at an edge; 0 is flat
    friend bool operator==(const Smoothness&, const Smoothness&) = default;  ///< member by member
};

/// The smoothness of a surface, and of its forks.
struct SmoothnessReport {
    Smoothness whole;                 ///< of all faces
    std::optional<Smoothness> forks;  ///< of faces whose middles lie within two radii of the nodes with three
                                      ///< neighbours; none without a skeleton
    std::optional<Smoothness> chains;  ///< of the others; none without a skeleton
    friend bool operator==(const SmoothnessReport&, const SmoothnessReport&) = default;  ///< member by member
};

/// Judges a valid mesh; `skeleton`, which may be null, tells where forks are, and may have another origin.
/// Faces without area, and edges of other than two faces, are left out. O(n log m) [n faces, m forks]; the
/// same bits for any number of threads.
SmoothnessReport smoothness(const PolygonMesh& mesh, const Skeleton* skeleton, const Context& ctx = {});
/// The same where the sides of the mesh have been sorted.
SmoothnessReport smoothness(const PolygonMesh& mesh, const Buffer<Side>& sides, const Skeleton* skeleton,
                            const Context& ctx = {});

}  // namespace coppice
