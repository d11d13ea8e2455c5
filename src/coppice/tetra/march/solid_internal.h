#pragma once

#include <array>
#include <cstdint>
#include <span>

#include "coppice/mesh/mesh.h"
#include "coppice/mesh/solid_mesh.h"
#include "coppice/tetra/march/crossed_internal.h"

namespace coppice::tetra_internal {

/// How the vertices of a surface are numbered: those that were moved onto it, then cut edges.
struct SurfaceNumbers {
    const CutNumbers& cuts;
    std::span<const std::uint32_t> placed;  ///< by rank in Samples::placed; 2^32 - 1 for those not in use
    std::uint32_t placed_count;
};

/// The fine tetrahedra inside a surface, and the inner parts of those that it crosses, cut so that they share
/// whole faces and that the triangles of the surface are all that is left over. Vertices of the surface come
/// first.
///
/// A part with two inner corners is a prism, or less, as is one with three. What of it lies in a face of the
/// fine tetrahedron and has four corners is cut from its inner corner of the lesser number, whichever side
/// looks at it; so the three cuts of a prism never go round in a ring, and it falls into three tetrahedra.
SolidMesh fill(const TetraRefinement& refinement, const Samples& samples, const CrossedTetra& crossed,
               const SurfaceNumbers& numbers, const TriMesh& surface, const Context& ctx);

}  // namespace coppice::tetra_internal
