#pragma once

#include <cstdint>
#include <vector>

#include "coppice/base/context.h"
#include "coppice/measure/intersections.h"
#include "coppice/mesh/control_mesh.h"
#include "coppice/mesh/mesh.h"
#include "coppice/skeleton/skeleton.h"

namespace coppice::pipeline_internal {

/// A surface of quads as it was before knots were remeshed. What of it is still there lies in rows around
/// tubes, of which hardly any needs a search for crossings, wherever its vertices lie: see unproved_quads().
class KeptQuads {
  public:
    /// Of rows around `tubes`, refined `levels` times.
    KeptQuads(QuadMesh before, Skeleton tubes, int levels)
        : rows_(std::move(before)), tubes_(std::move(tubes)), levels_(levels) {}

    /// Has to be told first what remeshing made of it: the quads that it kept, in order, and then others.
    void find_in(const QuadMesh& after);

    /// The pairs of faces that cross once vertices of that surface have been moved: what crossing_faces()
    /// finds, with the same limit. `cage` is that of the rows. O(n), but for what remeshing made and what
    /// lies near it.
    FacePairs crossings(const PolygonMesh& moved, const ControlMesh& cage, std::uint32_t limit,
                        const Context& ctx);

  private:
    /// Whether two quads have the same corners, which are no others' already.
    bool is_same(const Quad& old, const Quad& now, std::span<const Vec3> positions) const;

    static constexpr std::uint32_t kNone = 0xffffffffu;

    QuadMesh rows_;
    Skeleton tubes_;
    int levels_;
    std::vector<std::uint32_t> old_vertex_;  ///< per vertex that there is now, kNone where it is new
    std::vector<std::uint32_t> new_vertex_;  ///< per vertex of the rows, kNone where it is gone
    std::vector<std::uint32_t> old_quad_;    ///< per quad that was kept, ascending
};

}  // namespace coppice::pipeline_internal
