#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "coppice/base/column.h"
#include "coppice/base/compressed_rows.h"
#include "coppice/base/number_set.h"
#include "coppice/mesh/mesh.h"
#include "coppice/subdivision/kernel/patch_index.h"

namespace coppice {

/// Bad faces in clusters that are so far apart that the processing of one does not affect another: each owns
/// the vertices within some rings of its bad faces, and no face has vertices of two clusters. The result for
/// a cluster then depends on no other part of the surface, and clusters can be processed in parallel.
struct FoldClusters {
    CompressedRows<std::uint32_t> vertices;  ///< by cluster, ascending: may move, not on a boundary
    CompressedRows<std::uint32_t> faces;     ///< by cluster, ascending: all faces that have such a vertex
    CompressedRows<std::uint32_t> bad;       ///< by cluster, ascending: the bad faces among these
    std::vector<std::uint32_t> fixed;        ///< bad faces with all vertices on boundaries

    /// number of clusters
    std::size_t size() const { return vertices.size(); }
    /// Returns whether a vertex belongs to a cluster.
    bool may_move(std::uint32_t vertex) const { return movable_.contains(vertex); }
    /// Returns the index in its row of a vertex that may move.
    std::uint32_t vertex_place(std::uint32_t vertex) const { return vertex_place_[vertex]; }
    /// Returns the index in its row of a face that has such a vertex.
    std::uint32_t face_place(std::uint32_t face) const { return face_place_[face]; }

    /// `bad` is ascending. The cost is proportional to the size of the clusters, plus a bit per vertex and
    /// face.
    FoldClusters(std::span<const std::uint32_t> bad, std::size_t vertex_count, const PatchStars& stars);

  private:
    NumberSet movable_;
    Buffer<std::uint32_t> vertex_place_, face_place_;  ///< only the requested entries are set
};

}  // namespace coppice
