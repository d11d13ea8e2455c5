#pragma once

#include <vector>

#include "coppice/base/context.h"
#include "coppice/measure/capsule_tree.h"
#include "coppice/mesh/mesh.h"
#include "coppice/skeleton/skeleton.h"

namespace coppice {

/// Where the vertices of a surface lie along a skeleton.
struct VertexPlaces {
    std::vector<CapsuleTree::Nearest> nearest;  ///< none for a vertex of no face
    /// Whether a vertex projects to the inside of its segment, farther than two radii from its ends where it
    /// ends in a branch node, root or tip.
    std::vector<char> is_regular;
};

/// `capsules` must be those of `skeleton`, in the mesh's frame. O(n log m), n vertices and m nodes.
VertexPlaces vertex_places(const PolygonMesh& mesh, const Skeleton& skeleton, const CapsuleTree& capsules,
                           const Context& ctx = {});

}  // namespace coppice
