#pragma once

#include <cstdint>
#include <vector>

#include "coppice/base/compressed_rows.h"
#include "coppice/base/context.h"
#include "coppice/measure/capsule_tree.h"
#include "coppice/mesh/mesh.h"
#include "coppice/skeleton/skeleton.h"

namespace coppice::pipeline_internal {

/// The segments and radii of the vertices of a surface.
struct LocalRadii {
    std::vector<std::uint32_t> capsule;  ///< segment of its bark; kNoIndex: far from all
    std::vector<float> radius;           ///< [m] 0 without a segment
};

/// Returns the segment of each vertex and its radius. Radii grow at most by the distance along the surface,
/// over a few faces: vertices where a thin branch leaves a thick one are on the thick one, and would move the
/// thin one by a share of the radius of the thick one. The capsules are those of the skeleton. O(n log n).
LocalRadii find_local_radii(const PolygonMesh& mesh, const CompressedRows<std::uint32_t>& faces_of,
                            const Skeleton& skeleton, const CapsuleTree& capsules, const Context& ctx);

}  // namespace coppice::pipeline_internal
