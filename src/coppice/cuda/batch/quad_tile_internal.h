#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "coppice/base/number_set.h"
#include "coppice/base/parallel.h"
#include "coppice/base/vec.h"
#include "coppice/cuda/batch/job_arrays_internal.h"
#include "coppice/cuda/quads/quad_job.h"

namespace coppice::cuda {

/// A tile of a job that is too large for a GPU: some consecutive quads of its cage, and enough quads around
/// them that every vertex of its own quads is subdivided and moved bit-identically to the whole. The results
/// of the surrounding quads are invalid and unused.
///
/// Subdivision of a quad depends on the quads around its corners; a relaxation depends on the adjacent quads,
/// and for quads of a flat end on the whole end. The tile therefore contains one ring of quads more than
/// there are relaxations, and no flat end is divided. Unfolding has no limited range and must be done on the
/// whole.
class QuadTile {
  public:
    /// Selects the quads `own` of a whole job, which must outlive this object; they must not divide a flat
    /// end: see cut(). O(whole), with one bit for each quad and two numbers for each vertex and edge; then
    /// O(tile).
    QuadTile(const QuadJob& whole, IndexRange own);
    QuadTile(const QuadTile&) = delete;
    QuadTile& operator=(const QuadTile&) = delete;

    const QuadJob& job() const { return job_; }  ///< the tile; refers to this object
    IndexRange own() const { return own_; }      ///< quads of the tile itself
    /// Copies the values of its own quads from an array over the vertices of the refined tile to one over
    /// those of the refined whole. All tiles together write each element once.
    void put(std::span<const Vec3> of_tile, std::span<Vec3> of_whole) const;

    /// Returns a number of quads near `wanted` at which the quads of a job can be divided, in (begin, end) if
    /// there is one; otherwise `end`.
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
