#pragma once

#include <cstdint>
#include <vector>

#include "coppice/base/context.h"
#include "coppice/measure/intersections.h"
#include "coppice/mesh/mesh.h"
#include "coppice/pipeline/repair/tube_quads_internal.h"

namespace coppice::pipeline_internal {

inline constexpr std::uint32_t kMaxPairs = 1u << 20;  ///< maximum number of reported pairs

/// Returns the quads of the mesh of the rows, ascending, that may intersect or touch others; all other
/// quads neither intersect nor touch any quad: see crossings.cpp. About one quad in a hundred of a clean
/// mesh. O(n log n).
std::vector<std::uint32_t> unproved_quads(const QuadMesh& mesh, const TubeRows& tube_rows,
                                          const Context& ctx);

/// Result of the first check of a mesh.
struct TubeCrossings {
    std::vector<FacePair> pairs;  ///< pairs of quads that intersect or touch
    TubeQuads tubes;              ///< the quads of each tube
};

/// Returns the pairs of quads that intersect or touch: the result of crossing_faces() for the whole mesh, in
/// the same order, up to kMaxPairs. Only unproved_quads() are searched, so that a clean mesh needs about a
/// twentieth of the time. Mesh and tube_rows must outlive the result.
TubeCrossings find_tube_crossings(const QuadMesh& mesh, const TubeRows& tube_rows, const Context& ctx);

}  // namespace coppice::pipeline_internal
