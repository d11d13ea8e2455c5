#pragma once

#include <cstdint>
#include <vector>

#include "coppice/base/context.h"
#include "coppice/measure/intersections.h"
#include "coppice/mesh/mesh.h"
#include "coppice/pipeline/knots/tube_quads_internal.h"

namespace coppice::pipeline_internal {

inline constexpr std::uint32_t kMostPairs = 1u << 20;  ///< that are looked for

/// Quads of the mesh that the slices are of, ascending; all others cross or touch none of them, nor each
/// other: see crossings.cpp. Of a clean mesh about one in a hundred. O(n log n).
std::vector<std::uint32_t> unproved_quads(const QuadMesh& mesh, const Slices& slices, const Context& ctx);

/// What a first look at a mesh tells.
struct SliceCrossings {
    std::vector<FacePair> pairs;  ///< of quads that cross or touch
    TubeQuads tubes;              ///< where the quads of each tube lie
};

/// The pairs of quads that cross or touch: all that crossing_faces() finds in the whole mesh, in the same
/// order, up to kMostPairs. Only unproved_quads() are searched, so that a clean mesh takes about a
/// twentieth of the time. Mesh and slices must outlive what it returns.
SliceCrossings slice_crossings(const QuadMesh& mesh, const Slices& slices, const Context& ctx);

}  // namespace coppice::pipeline_internal
