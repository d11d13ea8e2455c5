#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "coppice/base/number_set.h"
#include "coppice/mesh/mesh.h"
#include "coppice/pipeline/quads/quad_build.h"
#include "coppice/pipeline/repair/tube_quads_internal.h"
#include "coppice/subdivision/kernel/patch_index.h"

namespace coppice::pipeline_internal {

/// The vertices of a surface by their positions in the refined cage.
class RefinedGrid {
  public:
    /// The arguments must outlive this object. O(vertices).
    RefinedGrid(const QuadMesh& mesh, const QuadBuild& build)
        : positions_(mesh.positions),
          build_(build),
          tube_rows_(build.cage, build.tubes, build.refinement.levels(), build.sides),
          faces_(faces_of_tubes(tube_rows_)),
          cage_(build.refinement.cage()),
          size_(1u << build.refinement.levels()),
          gone_(build.refinement.vertex_count()) {
        for (const std::uint32_t v : build.remeshed.gone) gone_.add(v);
        gone_.count();
    }

    const TubeRows& tube_rows() const { return tube_rows_; }                         ///< rows of quads
    const TubeFaces& faces(NodeId tube) const { return faces_[tube.index()]; }       ///< cage quads of a tube
    std::uint32_t vertex_count() const { return build_.refinement.vertex_count(); }  ///< of refined ones
    std::uint32_t size() const { return size_; }  ///< number of quads along the side of a cage quad
    std::uint32_t columns(const CageRun& side) const {
        return side.count * size_;
    }  ///< number of quads around the tube of these sides

    /// Returns the refined vertex in a column and a row of a cage quad, both from 0 to size().
    std::uint32_t vertex(std::uint32_t cage_quad, std::uint32_t column, std::uint32_t row) const {
        return patch_vertex(cage_, size_, cage_quad, column, row);
    }
    /// Returns the refined vertex in a column around a tube and a row along it; the last column is followed
    /// by the first.
    std::uint32_t vertex(const CageRun& side, std::uint32_t column, std::uint32_t row) const {
        column %= columns(side);
        return vertex(side.first + column / size_, column % size_, row);
    }

    /// Returns whether a row was not remeshed.
    bool stays(TubeRow s) const { return build_.remeshed.stays(s); }
    /// Returns whether no row of a tube was remeshed.
    bool is_whole(NodeId tube) const {
        for (TubeRow s = tube_rows_.first(tube); s <= tube_rows_.last(tube); ++s) {
            if (!stays(s)) return false;
        }
        return true;
    }
    /// Returns whether a cage quad that is not a side was not remeshed.
    bool has_patch(std::uint32_t cage_quad) const {
        return stays(tube_rows_.of_quad(cage_quad << (2 * tube_rows_.levels())));
    }

    /// Returns the index in the mesh of a kept refined vertex.
    std::uint32_t number(std::uint32_t v) const { return v - gone_.rank(v); }
    Vec3 position(std::uint32_t v) const { return positions_[number(v)]; }  ///< [m] of a kept vertex
    Vec3 anchor(std::uint32_t v) const { return build_.anchors[v]; }        ///< [m] of any vertex

  private:
    std::span<const Vec3> positions_;
    const QuadBuild& build_;
    TubeRows tube_rows_;
    std::vector<TubeFaces> faces_;  // per tube
    CageView cage_;
    std::uint32_t size_;
    NumberSet gone_;  // removed refined vertices
};

}  // namespace coppice::pipeline_internal
