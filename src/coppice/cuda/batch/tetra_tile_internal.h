#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "coppice/base/compressed_rows.h"
#include "coppice/base/number_set.h"
#include "coppice/base/parallel.h"
#include "coppice/tetra/lattice/refinement.h"

namespace coppice::cuda {

/// A tile of a tetrahedral mesh that is too large for a GPU: the tetrahedra of some consecutive regions,
/// which are its own, and rings of others around them. Vertices, tetrahedra and regions keep their order, so
/// that coarse elements are numbered in the same order and subdivided in the same way as in the whole mesh.
///
/// The result of march() at a fine vertex depends on the tetrahedra that contain it, except for vertices that
/// are moved back: that effect spreads by one fine edge in each round. The interior is therefore correct as
/// far as rings_for() states.
class TetraTile {
  public:
    /// Returns the number of rings around a tile that makes its own portion of the surface bit-identical to
    /// that of the whole mesh, if vertices are moved back in `rounds` rounds.
    ///
    /// Tetrahedra of all rings except the last have all their neighbours, so that their vertices are
    /// initially correct. Define the distance of a coarse vertex as the number of the first ring that
    /// contains it, and 0 for own vertices: as a linear function in each tetrahedron it changes by at most 2
    /// / 2^levels along a fine edge, and by 1 if levels is 0. Each round, and the evaluation of the last one,
    /// spreads by one such edge.
    static int rings_for(int rounds, int levels);

    /// Selects regions of a whole mesh, which must outlive this object. O(tile), and one bit for each coarse
    /// vertex and tetrahedron.
    TetraTile(const TetraRefinement& whole, IndexRange regions, int rings);

    const TetraMesh& mesh() const { return mesh_; }  ///< the tile
    IndexRange own() const { return own_; }          ///< its own tetrahedra, numbered in the tile
    /// Returns whether the tile is the whole connected component of its own tetrahedra, so that all of its
    /// results are correct.
    bool is_closed() const { return is_closed_; }
    std::uint32_t tetra(std::uint32_t i) const { return tetra_[i]; }     ///< number in the whole mesh
    std::span<const std::uint32_t> regions() const { return regions_; }  ///< numbers in the whole mesh
    /// Returns the rows of its regions, given one row for each region of the whole mesh, or no rows.
    CompressedRows<std::uint32_t> rows(const CompressedRows<std::uint32_t>& of_whole) const;

  private:
    ChosenNumbers tetra_around(const TetraRefinement& whole, IndexRange own, int rings);
    void take_mesh(const TetraMesh& whole);

    bool is_closed_ = false;
    ChosenNumbers tetra_;
    std::vector<std::uint32_t> regions_;
    IndexRange own_;
    TetraMesh mesh_;
};

}  // namespace coppice::cuda
