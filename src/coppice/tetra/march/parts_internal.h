#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "coppice/base/context.h"
#include "coppice/mesh/solid_mesh.h"
#include "coppice/tetra/march/closed_parts.h"
#include "coppice/tetra/march/samples_internal.h"

namespace coppice::tetra_internal {

/// [m] Where a held vertex of each set of axes is.
std::vector<Vec3> held_places(const TetraRefinement& refinement, const HeldVertices& held,
                              const Samples& samples);

/// Leaves out the bodies within parts of the surface that were left out. `solid` begins with the vertices of
/// the surface.
void drop_bodies(SolidMesh& solid, const DroppedParts& dropped);

/// Leaves out vertices of no tetrahedron.
void compact(SolidMesh& solid);

}  // namespace coppice::tetra_internal
