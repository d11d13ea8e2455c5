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

/// Bad faces in clusters so far apart that what is done about one never sees another: each has the vertices
/// within some rings of its bad faces for its own, and no face has vertices of two clusters. What becomes of
/// a cluster then depends on nothing that lies elsewhere, and clusters can be worked on side by side.
struct FoldClusters {
    CompressedRows<std::uint32_t> vertices;  ///< by cluster, ascending: that may move, none on a boundary
    CompressedRows<std::uint32_t> faces;     ///< by cluster, ascending: all that have such a vertex
    CompressedRows<std::uint32_t> bad;       ///< by cluster, ascending: of the faces, those that are bad
    std::vector<std::uint32_t> fixed;        ///< bad faces all of whose vertices lie on boundaries

    /// number of clusters
    std::size_t size() const { return vertices.size(); }
    /// Whether a vertex is one of a cluster's own.
    bool may_move(std::uint32_t vertex) const { return movable_.contains(vertex); }
    /// The place in its row of a vertex that may move.
    std::uint32_t vertex_place(std::uint32_t vertex) const { return vertex_place_[vertex]; }
    /// The place in its row of a face that has such a vertex.
    std::uint32_t face_place(std::uint32_t face) const { return face_place_[face]; }

    /// `bad` ascends. Costs what the clusters have, and a bit per vertex and face.
    FoldClusters(std::span<const std::uint32_t> bad, std::size_t vertex_count, const PatchStars& stars);

  private:
    NumberSet movable_;
    Buffer<std::uint32_t> vertex_place_, face_place_;  ///< only those that are asked for are set
};

}  // namespace coppice
