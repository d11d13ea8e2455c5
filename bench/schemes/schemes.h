#pragma once

#include <string_view>

#include "coppice/mesh/mesh.h"

namespace coppice::bench {

/// The subdivision schemes that [Huang2017] compares in its figure 2, and Zorin's butterfly.
enum class Scheme {
    loop,                ///< triangles, approximating [Loop1987]
    butterfly,           ///< triangles, interpolating: Dyn's eight points with w = 1/16 everywhere [Dyn1990]
    modified_butterfly,  ///< the same with special stencils around irregular vertices [Zorin1996]
    doo_sabin,           ///< faces shrink, and new ones fill edges and corners [Doo1978]
    catmull_clark,       ///< quads, approximating [Catmull1978]: the scheme of our cages
};

/// Returns the name in the tables.
std::string_view name_of(Scheme scheme);

/// Returns whether a scheme requires triangles.
bool takes_triangles(Scheme scheme);

/// Divides every face into a fan from its first corner.
PolygonMesh triangulated(const PolygonMesh& mesh);

/// Executes one step. The mesh must be closed and manifold, of triangles if the scheme requires them, and of
/// quads for Catmull-Clark. O(n log n): for small meshes.
PolygonMesh subdivided(const PolygonMesh& mesh, Scheme scheme);

}  // namespace coppice::bench
