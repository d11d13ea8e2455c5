#pragma once

#include <cstdint>
#include <span>
#include <utility>
#include <vector>

#include "coppice/base/context.h"
#include "coppice/base/id.h"
#include "coppice/measure/intersections.h"
#include "coppice/mesh/control_mesh.h"
#include "coppice/mesh/mesh.h"
#include "coppice/skeleton/skeleton.h"

namespace coppice::pipeline_internal {

/// A surface of quads before its self-intersections are remeshed.
struct QuadRows {
    QuadMesh mesh;
    Skeleton tubes;  ///< tubes of its rows
    int levels = 0;  ///< number of refinements of its cage
};

/// The quads of such a surface that remeshing kept: rows around tubes, of which very few require a search for
/// crossings, for any vertex positions (see unproved_quads).
class KeptQuads {
  public:
    /// `after` contains the kept quads, in order, and then others. The cage, that of the rows, must outlive
    /// this object. O(n).
    KeptQuads(QuadRows before, const ControlMesh& cage, const QuadMesh& after);

    /// Returns the pairs of faces that cross after vertices of `after` have been moved: the result of
    /// crossing_faces(), with the same limit. O(n), except for remeshed quads and their neighbourhood.
    FacePairs crossings(const PolygonMesh& moved, std::uint32_t limit, const Context& ctx);

    /// Sets new positions of the tubes, corresponding to those of the vertices: the same nodes. Wrong
    /// positions only cost time.
    void move_tubes(Skeleton tubes) { rows_.tubes = std::move(tubes); }
    /// Per vertex of `after` the vertex of the rows, or kNoIndex.
    std::span<const std::uint32_t> old_vertices() const { return old_vertex_; }

  private:
    void find_in(const QuadMesh& after);
    /// Returns whether two quads have the same corners, not yet assigned to others.
    bool is_same(const Quad& old, const Quad& now, std::span<const Vec3> positions) const;

    QuadRows rows_;
    const ControlMesh* cage_;
    std::vector<std::uint32_t> old_vertex_;  ///< per current vertex, kNoIndex if it is new
    std::vector<std::uint32_t> new_vertex_;  ///< per vertex of the rows, kNoIndex if it was removed
    std::vector<std::uint32_t> old_quad_;    ///< per kept quad, ascending
};

}  // namespace coppice::pipeline_internal
