#pragma once

#include <cstdint>

#include "coppice/cuda/tetra/cut_convolution.h"
#include "coppice/tetra/lattice/tetra_mesh.h"
#include "coppice/tetra/march/march.h"

namespace coppice::cuda {

/// What march() makes a surface of, where the field is one that a card can sample. Refers to its parts.
struct MarchInput {
    const TetraMesh& mesh;        ///< that encloses the surface
    const CutConvolution& field;  ///< whatever regions it has
    const InsideAxes& axes;       ///< by the regions of the mesh
    const MarchOptions& options;  ///< how fine
};

/// [bytes] That marching takes on a card, about, but for the surface and the field: some 20 for each fine
/// vertex, of which there is one for every 5 fine tetrahedra, 1.5 bits for each fine edge and fine
/// tetrahedron, and 400 for each coarse one.
constexpr std::uint64_t bytes_of_march(std::uint64_t coarse, int levels) {
    const std::uint64_t fine = coarse << (3 * levels);
    return 400 * coarse + 20 * (fine / 5) + fine / 2;
}

}  // namespace coppice::cuda
