#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "coppice/base/compressed_rows.h"
#include "coppice/base/number_set.h"
#include "coppice/base/parallel.h"
#include "coppice/tetra/lattice/refinement.h"

namespace coppice::cuda {

/// A piece of tetrahedra that are too many for a card: those of some consecutive regions, which are its own,
/// and rings of others around them. Vertices, tetrahedra and regions keep their order, so that coarse parts
/// are numbered in the same order and cut in the same way as in the whole.
///
/// What march() finds at a fine vertex depends on the tetrahedra that have it, but for what was put back:
/// that goes by one fine edge with each round. So all of it is right inside, as far as rings_for() says.
class TetraPiece {
  public:
    /// How many rings there have to be around a piece for its own part of the surface to come out as in the
    /// whole, to the bit, where vertices are put back in so many rounds.
    ///
    /// Tetrahedra of all rings but the last have all others about them, so that their vertices begin right.
    /// Call a coarse vertex as far as the number of the first ring that has it, and own ones 0: as a linear
    /// function in each tetrahedron this changes by 2 / 2^levels at most along a fine edge, by 1 where levels
    /// is 0. Each round, and looking at the last one's outcome, takes one such edge.
    static int rings_for(int rounds, int levels);

    /// Of a whole that outlives this. O(piece), and a bit for each coarse vertex and tetrahedron.
    TetraPiece(const TetraRefinement& whole, IndexRange regions, int rings);

    const TetraMesh& mesh() const { return mesh_; }  ///< the piece
    IndexRange own() const { return own_; }          ///< its own tetrahedra, in the piece
    /// Whether it is all that hangs together with its own tetrahedra, so that nothing in it is wrong.
    bool is_closed() const { return is_closed_; }
    std::uint32_t tetra(std::uint32_t i) const { return tetra_[i]; }     ///< the number in the whole
    std::span<const std::uint32_t> regions() const { return regions_; }  ///< their numbers in the whole
    /// Those of some rows, one for each region of the whole or none at all, that belong to its regions.
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
