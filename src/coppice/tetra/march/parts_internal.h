#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "coppice/base/context.h"
#include "coppice/mesh/mesh.h"
#include "coppice/tetra/march/samples_internal.h"

namespace coppice::tetra_internal {

/// [m] Where a held vertex of each set of axes is.
std::vector<Vec3> held_places(const TetraRefinement& refinement, const HeldVertices& held,
                              const Samples& samples);

/// Leaves out closed parts of a surface that enclose none of these places, and hollows, which are inside out.
/// Returns how many. O(triangles), and O(triangles of the parts about it) for each place.
std::uint64_t drop_parts(TriMesh& mesh, std::span<const Vec3> places, const Context& ctx);

}  // namespace coppice::tetra_internal
