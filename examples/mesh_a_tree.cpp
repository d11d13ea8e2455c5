// mesh_a_tree SKELETON MESH: reads a skeleton file, computes its surface, and writes it.

#include <cstdio>
#include <exception>

#include "coppice/io_mesh/writer.h"
#include "coppice/io_skeleton/reader.h"
#include "coppice/pipeline/mesh_skeleton.h"

int main(int argc, char** argv) {
    if (argc != 3) {
        std::fprintf(stderr, "usage: mesh_a_tree SKELETON MESH\n");
        return 2;
    }
    try {
        const coppice::SkeletonFile file = coppice::read_skeleton(argv[1]);
        coppice::MeshOptions options;
        options.levels = 2;
        const coppice::MeshResult result = coppice::mesh_skeleton(file.skeleton, options);
        coppice::write_mesh(argv[2], result.quads().mesh);
        std::printf("%u nodes, %zu quads\n", file.skeleton.size(), result.quads().mesh.quads.size());
    } catch (const std::exception& error) {
        std::fprintf(stderr, "mesh_a_tree: %s\n", error.what());
        return 1;
    }
    return 0;
}
