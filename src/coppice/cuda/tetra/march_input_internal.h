#pragma once

#include <cstdint>

#include "coppice/cuda/tetra/cut_convolution.h"
#include "coppice/tetra/lattice/tetra_mesh.h"
#include "coppice/tetra/march/march.h"

namespace coppice::cuda {

/// Input of march() with a field that a GPU can sample. Refers to its members.
struct MarchInput {
    const TetraMesh& mesh;        ///< encloses the surface
    const CutConvolution& field;  ///< its regions are not used
    const InsideAxes& axes;       ///< by the regions of the mesh
    const MarchOptions& options;  ///< resolution
};

/// [bytes] Returns the approximate memory for marching on a GPU, except the surface and the field: about 20
/// for each fine vertex, one for every 5 fine tetrahedra; 1.5 bits for each fine edge and fine tetrahedron;
/// and 400 for each coarse tetrahedron.
constexpr std::uint64_t bytes_of_march(std::uint64_t coarse, int levels) {
    const std::uint64_t fine = coarse << (3 * levels);
    return 400 * coarse + 20 * (fine / 5) + fine / 2;
}

}  // namespace coppice::cuda
