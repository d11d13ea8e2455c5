#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "coppice/base/number_set.h"
#include "coppice/pipeline/knots/remesh_knots_internal.h"
#include "coppice/pipeline/knots/tube_quads_internal.h"
#include "coppice/pipeline/mesh_skeleton.h"
#include "coppice/subdivision/catmull_clark.h"
#include "coppice/subdivision/kernel/patch_index.h"

namespace coppice::pipeline_internal {

/// What a surface of quads was made of.
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
          from_(from),
          slices_(surface.cage, from.map.tubes, from.patches.levels(), from.map.sides),
          faces_(faces_of_tubes(slices_)),
          cage_(from.patches.cage()),
          size_(1u << from.patches.levels()),
          gone_(from.patches.vertex_count()) {
        for (const std::uint32_t v : from.remeshed.gone) gone_.add(v);
        gone_.count();
    }

    const Slices& slices() const { return slices_; }                             ///< rows of quads
    const TubeFaces& faces(NodeId tube) const { return faces_[tube.index()]; }   ///< of the cage
    std::uint32_t vertex_count() const { return from_.patches.vertex_count(); }  ///< refined ones
    std::uint32_t size() const { return size_; }  ///< quads along the side of a cage quad
    std::uint32_t columns(const CageRun& side) const {
        return side.count * size_;
    }  ///< quads around the tube of these sides

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

    /// Whether a slice was not remeshed.
    bool stays(Slice s) const { return from_.remeshed.stays(s); }
    /// Whether no slice of a tube was.
    bool is_whole(NodeId tube) const {
        for (Slice s = slices_.first(tube); s <= slices_.last(tube); ++s) {
            if (!stays(s)) return false;
        }
        return true;
    }
    /// Whether a cage quad that is no side was not remeshed.
    bool has_patch(std::uint32_t cage_quad) const {
        return stays(slices_.of_quad(cage_quad << (2 * slices_.levels())));
    }

    /// The number in the mesh of a refined vertex that stays.
    std::uint32_t number(std::uint32_t v) const { return v - gone_.rank(v); }
    Vec3 position(std::uint32_t v) const { return positions_[number(v)]; }  ///< [m] of one that stays
    Vec3 anchor(std::uint32_t v) const { return from_.anchors[v]; }         ///< [m] of any

  private:
    std::span<const Vec3> positions_;
    const RefinedQuads& from_;
    Slices slices_;
    std::vector<TubeFaces> faces_;  // per tube
    CageView cage_;
    std::uint32_t size_;
    NumberSet gone_;  // of the refined vertices
};

}  // namespace coppice::pipeline_internal
