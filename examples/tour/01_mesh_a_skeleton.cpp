// Builds a skeleton, and the surface around it.

#include <cstdio>

#include "coppice/pipeline/mesh_skeleton.h"

int main() {
    using coppice::NodeId;
    using coppice::Vec3;

    // A trunk that forks: parents precede their children, and a root has no parent. Metres, Z up.
    const coppice::Skeleton tree({NodeId::none(), NodeId(0), NodeId(1), NodeId(1)},
                                 {Vec3{0, 0, 0}, Vec3{0, 0, 2}, Vec3{-0.7f, 0, 3.2f}, Vec3{0.9f, 0, 3}},
                                 {0.2f, 0.15f, 0.08f, 0.1f});

    const coppice::MeshResult result = coppice::mesh_skeleton(tree);

    const coppice::QuadMesh& mesh = result.quads().mesh;
    std::printf("%u nodes, %u tree\n", tree.size(), tree.tree_count());
    std::printf("%zu vertices, %zu quads\n", mesh.positions.size(), mesh.quads.size());
    std::printf("the cage before subdivision: %zu quads\n", result.quads().cage.cage.quads.size());
    for (const coppice::NodeId n : coppice::nodes(tree)) {
        std::printf("node %u: radius %.2f m, %zu children%s\n", n.index(), tree.radius(n),
                    tree.children(n).size(), tree.is_tip(n) ? ", a tip" : "");
    }
}
