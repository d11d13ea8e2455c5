#pragma once

#include <string_view>

#include "coppice/mesh/mesh.h"

namespace coppice::bench {

/// The subdivision schemes that [Huang2017] holds beside each other in its figure 2, and Zorin's butterfly.
enum class Scheme {
    loop,                ///< triangles, approximating [Loop1987]
    butterfly,           ///< triangles, interpolating: Dyn's eight points with w = 1/16 everywhere [Dyn1990]
    modified_butterfly,  ///< the same with stencils of their own around irregular vertices [Zorin1996]
    doo_sabin,           ///< faces shrink, and new ones fill edges and corners [Doo1978]
    catmull_clark,       ///< quads, approximating [Catmull1978]: what our cages are refined by
};

/// Of the tables.
std::string_view name_of(Scheme scheme);

/// Whether it takes triangles alone.
bool takes_triangles(Scheme scheme);

/// Cuts every face into a fan from its first corner.
PolygonMesh triangulated(const PolygonMesh& mesh);

/// One step. The mesh must be closed and manifold, and of triangles where the scheme takes these alone; for
/// Catmull-Clark of quads. O(n log n): for small meshes.
PolygonMesh subdivided(const PolygonMesh& mesh, Scheme scheme);

}  // namespace coppice::bench
