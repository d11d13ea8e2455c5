#include "coppice/scene/mesh_memory.h"

#include <gtest/gtest.h>

#include "coppice/skeleton/random_tree.h"

namespace coppice {
namespace {

MeshOptions tetrahedra(float edge, int levels) {
    MeshOptions options;
    options.method = MeshMethod::tetrahedra;
    options.tetra.edge = edge;
    options.tetra.march.levels = levels;
    return options;
}

/// Returns the measured memory [bytes] of tetrahedra: 170 for each of the octree, and 65 for each that the
/// surface crosses.
double taken(const TetraSurface& made) { return 170.0 * made.coarse + 65.0 * made.march.crossed; }

// A cone with a radius that decreases to a thousandth: its length in radii is that of a cylinder of ln(1000)
// / 0.999 radii per metre.
Skeleton spike() { return {{NodeId::none(), NodeId(0)}, {{0, 0, 0}, {0, 0, 10}}, {1, 0.001f}}; }

TEST(MeshMemory, EstimateForTetrahedraIsWithinAFactorOfFour) {
    const std::vector<Skeleton> trees{random_tree(100, 3), random_tree(100, 3, true), spike()};
    for (std::size_t i = 0; i < trees.size(); ++i) {
        for (const auto& [edge, levels] : {std::pair(0.4f, 0), std::pair(0.4f, 1), std::pair(0.5f, 2),
                                           std::pair(1.5f, 0), std::pair(3.0f, 1)}) {
            const MeshOptions options = tetrahedra(edge, levels);
            const double estimate = memory_of_mesh(trees[i], options);
            const double real = taken(mesh_skeleton(trees[i], options).tetrahedra());
            EXPECT_GE(estimate, real) << "tree " << i << " edge " << edge << " levels " << levels;
            EXPECT_LE(estimate, 4 * real + 1e6) << "tree " << i << " edge " << edge << " levels " << levels;
        }
    }
}

// Four times as many quads per level; each needs about 100 bytes during the computation.
TEST(MeshMemory, EstimateForQuadsIsProportionalToTheirNumber) {
    const Skeleton tree = random_tree(100, 3);
    MeshOptions options;
    options.levels = 2;
    const auto quads = static_cast<double>(mesh_skeleton(tree, options).quads().mesh.quads.size());
    EXPECT_GE(memory_of_mesh(tree, options), 90 * quads);
    const double two = memory_of_mesh(tree, options);
    options.levels = 3;
    const double three = memory_of_mesh(tree, options);
    options.levels = 4;
    EXPECT_NEAR((memory_of_mesh(tree, options) - three) / (three - two), 4, 1e-9);
}

}  // namespace
}  // namespace coppice
