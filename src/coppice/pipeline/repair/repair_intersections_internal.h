#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "coppice/base/node_join.h"
#include "coppice/mesh/mesh.h"
#include "coppice/pipeline/mesh_result.h"
#include "coppice/pipeline/quads/quad_build.h"
#include "coppice/subdivision/untangle.h"

namespace coppice::pipeline_internal {

/// Returns per node of some tubes the first root of its tree and all trees that are joined to it.
std::vector<NodeId> body_roots(const Skeleton& tubes, std::span<const NodeJoin> joins);

/// Results of remeshing.
struct RemeshResult {
    RemeshReport report;
    RemeshTrace trace;
};

/// Replaces the quads of rows that intersect others, or themselves, or sever an axis, by quads made from the
/// surface that tetrahedra find there, which never intersects itself, until no quads intersect; each round
/// removes more of the tubes or raises repair levels, and finally replaces whole trees. `mesh`: the refined
/// quads of the build. The result at one location does not depend on others, except for that last resort.
/// `wanted`: per tube whether it is checked; empty for all. A tube adjacent to these may be replaced with
/// them.
RemeshResult repair_intersections(QuadMesh& mesh, const UntangleReport& untangled, const QuadBuild& build,
                                  std::span<const std::uint8_t> wanted, const Context& ctx);

}  // namespace coppice::pipeline_internal
