#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "coppice/base/number_set.h"
#include "coppice/base/parallel.h"
#include "coppice/base/vec.h"
#include "coppice/cuda/batch/job_arrays.h"
#include "coppice/cuda/quads/quad_job.h"

namespace coppice::cuda {

/// A piece of a job that is too large for a card: some consecutive quads of its cage, and as many around them
/// as it takes for every vertex of theirs to be subdivided and moved as in the whole, to the bit. What is
/// around them comes out wrong, and is not looked at.
///
/// Subdivision of a quad looks at the quads about its corners; a relaxation at the quads around, and where
/// one of these is of a flat end at all of that: so there are as many rings of quads around as there are
/// relaxations, and one more, and no flat end is cut. Unfolding spreads as far as there are folds: it has to
/// be done on the whole.
class QuadPiece {
  public:
    /// Quads of a whole that outlives it, which cut no flat end: see cut(). O(whole), a bit for each quad and
    /// two numbers for each vertex and edge; then O(piece).
    QuadPiece(const QuadJob& whole, IndexRange own);
    QuadPiece(const QuadPiece&) = delete;
    QuadPiece& operator=(const QuadPiece&) = delete;

    const QuadJob& job() const { return job_; }  ///< the piece; refers to this object
    IndexRange own() const { return own_; }      ///< its quads
    /// Copies what belongs to its quads from an array over the vertices of the refined piece to one over
    /// those of the refined whole. All pieces together write each place once.
    void put(std::span<const Vec3> of_piece, std::span<Vec3> of_whole) const;

    /// A number of quads near `wanted` at which the quads of a job can be cut, in (begin, end) if there is
    /// one; else `end`.
    static std::size_t cut(std::span<const ClipPlane> clips, IndexRange quads, std::size_t wanted);

  private:
    bool owns(std::uint32_t half) const { return own_.begin <= half >> 2 && half >> 2 < own_.end; }
    ChosenNumbers faces_around() const;
    ChosenNumbers vertices_of_faces() const;
    ChosenNumbers edges_of_faces() const;
    void take_faces();
    void take_vertices();
    void take_edges();
    std::uint32_t local_half(std::uint32_t half) const;

    const QuadJob& whole_;
    IndexRange own_;
    ChosenNumbers faces_, vertices_, edges_;
    JobArrays arrays_;
    QuadJob job_;
};

}  // namespace coppice::cuda
