#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "coppice/base/context.h"
#include "coppice/mesh/mesh.h"
#include "coppice/points/point_set.h"
#include "coppice/skeleton/skeleton.h"

namespace coppice::bench {

/// Distribution of leaves on a synthetic tree: evenly along branches up to a maximum thickness, in all
/// directions, mostly facing the sky, slightly folded and bent.
struct Foliage {
    double thickest = 0;  ///< [m] maximum radius of the branches with leaves
    double density = 0;   ///< [1/m] number of leaves per length of those branches
    double size = 0.06;   ///< [m] mean length of a leaf; its width is slightly more than half
};

/// Returns the foliage of this name: none, sparse, usual, dense. Throws InvalidInput for others.
Foliage foliage_named(const std::string& name);

/// Adds the leaves of a tree to its mesh, each as eight triangles.
void add_foliage(PolygonMesh& mesh, const Skeleton& tree, const Foliage& foliage);

/// Points of a tree from four scanners, and whether each is on a leaf.
struct LeafyScan {
    PointSet points;
    std::vector<std::uint8_t> leaf;
    double leaf_share() const;
};

/// Scans from 0.9 diagonals of the tree away, with noise of 2 mm in range.
LeafyScan scan_leafy_tree(const Skeleton& tree, const Foliage& foliage, int points, const Context& ctx);

}  // namespace coppice::bench
