#pragma once

#include <cstdint>
#include <span>
#include <utility>
#include <vector>

#include "coppice/base/context.h"
#include "coppice/measure/intersections.h"
#include "coppice/mesh/control_mesh.h"
#include "coppice/mesh/mesh.h"
#include "coppice/skeleton/skeleton.h"

namespace coppice::pipeline_internal {

/// A surface of quads before its knots are remeshed.
struct QuadRows {
    QuadMesh mesh;
    Skeleton tubes;  ///< that its rows go around
    int levels = 0;  ///< times that its cage was refined
};

/// What is left of such a surface after remeshing: rows around tubes, of which hardly any needs a search for
/// crossings, wherever its vertices lie (see unproved_quads).
class KeptQuads {
  public:
    /// `after` has the quads that were kept, in order, and then others. The cage, that of the rows, must
    /// outlive this. O(n).
    KeptQuads(QuadRows before, const ControlMesh& cage, const QuadMesh& after);

    /// The pairs of faces that cross once vertices of `after` have been moved: what crossing_faces() finds,
    /// with the same limit. O(n), but for what remeshing made and what lies near it.
    FacePairs crossings(const PolygonMesh& moved, std::uint32_t limit, const Context& ctx);

    /// That the tubes lie elsewhere now, as the vertices will: the same nodes. Wrong places cost time alone.
    void move_tubes(Skeleton tubes) { rows_.tubes = std::move(tubes); }
    /// Per vertex of `after` that of the rows, or kNone.
    std::span<const std::uint32_t> old_vertices() const { return old_vertex_; }

    static constexpr std::uint32_t kNone = 0xffffffffu;  ///< no vertex

  private:
    void find_in(const QuadMesh& after);
    /// Whether two quads have the same corners, which are no others' already.
    bool is_same(const Quad& old, const Quad& now, std::span<const Vec3> positions) const;

    QuadRows rows_;
    const ControlMesh* cage_;
    std::vector<std::uint32_t> old_vertex_;  ///< per vertex that there is now, kNone where it is new
    std::vector<std::uint32_t> new_vertex_;  ///< per vertex of the rows, kNone where it is gone
    std::vector<std::uint32_t> old_quad_;    ///< per quad that was kept, ascending
};

}  // namespace coppice::pipeline_internal
