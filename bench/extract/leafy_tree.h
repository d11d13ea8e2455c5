#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "coppice/base/context.h"
#include "coppice/mesh/mesh.h"
#include "coppice/points/point_set.h"
#include "coppice/skeleton/skeleton.h"

namespace coppice::bench {

/// How leaves stand on a made-up tree: evenly along branches up to a thickness, in all directions, with faces
/// rather to the sky, somewhat folded and bent.
struct Foliage {
    double thickest = 0;  ///< [m] radius of the branches that bear leaves
    double density = 0;   ///< [1/m] leaves per length of those
    double size = 0.06;   ///< [m] mean length of a leaf; its width is a bit more than half
};

/// By name: none, sparse, usual, dense. Throws InvalidInput for others.
Foliage foliage_named(const std::string& name);

/// Adds the leaves of a tree to its mesh, each as eight triangles.
void add_foliage(PolygonMesh& mesh, const Skeleton& tree, const Foliage& foliage);

/// Points that four scanners see of a tree, and which of them lie on leaves.
struct LeafyScan {
    PointSet points;
    std::vector<std::uint8_t> leaf;
    double leaf_share() const;
};

/// The scanners stand 0.9 diagonals of the tree away; noise of 2 mm in range.
LeafyScan scan_leafy_tree(const Skeleton& tree, const Foliage& foliage, int points, const Context& ctx);

}  // namespace coppice::bench
