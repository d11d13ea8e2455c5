#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "coppice/base/context.h"
#include "coppice/mesh/mesh.h"
#include "coppice/mesh/solid_mesh.h"
#include "coppice/tetra/march/samples_internal.h"

namespace coppice::tetra_internal {

/// [m] Where a held vertex of each set of axes is.
std::vector<Vec3> held_places(const TetraRefinement& refinement, const HeldVertices& held,
                              const Samples& samples);

/// Closed parts that were left out.
struct DroppedParts {
    std::uint64_t count = 0;
    /// If there are any: for every vertex before, and one beyond, the number of those kept before it.
    std::vector<std::uint32_t> number;
};

/// Leaves out closed parts of a surface that enclose none of these places, and if wanted hollows, which are
/// inside out. O(triangles), and O(triangles of the parts about it) for each place.
DroppedParts drop_parts(TriMesh& mesh, std::span<const Vec3> places, bool with_hollows, const Context& ctx);

/// Leaves out the bodies within parts of the surface that were left out. `solid` begins with the vertices of
/// the surface.
void drop_bodies(SolidMesh& solid, const DroppedParts& dropped);

/// Leaves out vertices of no tetrahedron.
void compact(SolidMesh& solid);

}  // namespace coppice::tetra_internal
