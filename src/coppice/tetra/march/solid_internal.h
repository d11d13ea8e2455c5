#pragma once

#include <array>
#include <cstdint>
#include <span>

#include "coppice/mesh/mesh.h"
#include "coppice/mesh/solid_mesh.h"
#include "coppice/tetra/march/crossed_internal.h"

namespace coppice::tetra_internal {

/// Numbering of the vertices of a surface: vertices that were moved onto it, then cut edges.
struct SurfaceNumbers {
    const CutNumbers& cuts;
    std::span<const std::uint32_t> placed;  ///< by rank in Samples::placed; 2^32 - 1 for unused vertices
    std::uint32_t placed_count;
};

/// Returns the fine tetrahedra inside a surface, and the inner portions of those that it crosses, cut such
/// that they share whole faces and the unshared faces are the triangles of the surface. Vertices of the
/// surface come first.
///
/// A portion with two or three inner corners is a prism or a degenerate prism. Its quadrilaterals in faces of
/// the fine tetrahedron are cut from their inner corner with the smaller number, independently of the side;
/// the three cuts of a prism therefore never form a cycle, and it is divided into three tetrahedra.
SolidMesh fill(const TetraRefinement& refinement, const Samples& samples, const CrossedTetra& crossed,
               const SurfaceNumbers& numbers, const TriMesh& surface, const Context& ctx);

}  // namespace coppice::tetra_internal
