#pragma once

#include <vector>

#include "coppice/base/context.h"
#include "coppice/measure/capsule_tree.h"
#include "coppice/mesh/mesh.h"
#include "coppice/skeleton/skeleton.h"

namespace coppice {

/// The positions of the vertices of a surface along a skeleton.
struct VertexPlaces {
    std::vector<CapsuleTree::Nearest> nearest;  ///< without a capsule for a vertex of no face
    /// Whether a vertex projects to the interior of its segment, farther than two radii from each end that is
    /// a branch node, root or tip.
    std::vector<char> is_regular;
};

/// Computes the positions. `capsules` must be the capsules of `skeleton`, in the mesh's frame. O(n log m), n
/// vertices and m nodes.
VertexPlaces vertex_places(const PolygonMesh& mesh, const Skeleton& skeleton, const CapsuleTree& capsules,
                           const Context& ctx = {});

}  // namespace coppice
