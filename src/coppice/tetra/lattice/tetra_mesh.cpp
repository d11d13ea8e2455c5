#include "coppice/tetra/lattice/tetra_mesh.h"

#include "coppice/base/parallel.h"

namespace coppice {

std::vector<Box3> region_boxes(const TetraMesh& mesh, const Context& ctx) {
    constexpr std::size_t kGrain = 1024;
    std::vector<Box3> boxes(mesh.region_count());
    parallel_for(ctx, boxes.size(), kGrain, [&](std::size_t r) {
        for (std::uint32_t t = mesh.first[r]; t < mesh.first[r + 1]; ++t) {
            for (const std::uint32_t v : mesh.tetra[t]) boxes[r].extend(mesh.positions[v]);
        }
    });
    return boxes;
}

}  // namespace coppice
