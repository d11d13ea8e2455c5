#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "coppice/base/context.h"
#include "coppice/mesh/solid_mesh.h"
#include "coppice/tetra/march/closed_components.h"
#include "coppice/tetra/march/samples_internal.h"

namespace coppice::tetra_internal {

/// [m] Returns the position of one held vertex of each set of axes.
std::vector<Vec3> held_places(const TetraRefinement& refinement, const HeldVertices& held,
                              const Samples& samples);

/// Removes the bodies inside removed components of the surface. `solid` begins with the vertices of the
/// surface.
void drop_bodies(SolidMesh& solid, const RemovedComponents& dropped);

/// Removes vertices without tetrahedra.
void compact(SolidMesh& solid);

}  // namespace coppice::tetra_internal
