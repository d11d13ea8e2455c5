#pragma once

#include <cstdint>
#include <span>

#include "coppice/base/number_set.h"
#include "coppice/pipeline/knots/remesh_knots_internal.h"
#include "coppice/pipeline/knots/tube_quads_internal.h"
#include "coppice/pipeline/mesh_skeleton.h"
#include "coppice/subdivision/catmull_clark.h"
#include "coppice/subdivision/kernel/patch_index.h"

namespace coppice::pipeline_internal {

/// A surface of quads and what it was made of.
struct RefinedQuads {
    const TubeMap& map;
    const PatchRefinement& patches;  ///< from the cage to the refined quads
    std::span<const Vec3> anchors;   ///< per refined vertex
    const RemeshTrace& remeshed;     ///< from the refined quads to the mesh
};

/// The vertices of a surface by their places in the refined cage.
class RefinedGrid {
  public:
    /// All must outlive this. O(vertices).
    RefinedGrid(const QuadSurface& surface, const RefinedQuads& from)
        : positions_(surface.mesh.positions),
          cage_(from.patches.cage()),
          size_(1u << from.patches.levels()),
          gone_(from.patches.vertex_count()) {
        for (const std::uint32_t v : from.remeshed.gone) gone_.add(v);
        gone_.count();
    }

    /// Quads along the side of a cage quad.
    std::uint32_t size() const { return size_; }
    /// Quads around the tube of these sides.
    std::uint32_t columns(const CageRun& side) const { return side.count * size_; }

    /// The refined vertex in a column and a row of a cage quad, both from 0 to size().
    std::uint32_t vertex(std::uint32_t cage_quad, std::uint32_t column, std::uint32_t row) const {
        return patch_vertex(cage_, size_, cage_quad, column, row);
    }
    /// The refined vertex in a column around a tube and a row along it; after the last column comes the
    /// first.
    std::uint32_t vertex(const CageRun& side, std::uint32_t column, std::uint32_t row) const {
        column %= columns(side);
        return vertex(side.first + column / size_, column % size_, row);
    }

    /// Whether a refined vertex went when the surface was remeshed.
    bool is_gone(std::uint32_t v) const { return gone_.contains(v); }
    /// The number in the mesh of a refined vertex that is not gone.
    std::uint32_t number(std::uint32_t v) const { return v - gone_.rank(v); }
    /// [m] Its position.
    Vec3 position(std::uint32_t v) const { return positions_[number(v)]; }

  private:
    std::span<const Vec3> positions_;
    CageView cage_;
    std::uint32_t size_;
    NumberSet gone_;
};

}  // namespace coppice::pipeline_internal
