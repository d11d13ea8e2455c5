#include "face_at.h"

#include <limits>

namespace coppice::bench {

std::uint32_t face_at(const SurfaceTree& tree, Vec3d p) {
    double best = std::numeric_limits<double>::infinity();
    std::uint32_t face = 0;
    const auto bound = [&](std::uint32_t level, std::uint32_t i) {
        return distance_squared(tree.boxes().level(level)[i], p);
    };
    tree.boxes().search(bound, best, [&](std::uint32_t item) {
        const SurfaceTree::TriangleRun& run = tree.run(item);
        const auto corner = [&](std::uint32_t v) { return Vec3d(tree.mesh().positions[v]); };
        for (const Triangle& t : tree.triangles(run)) {
            const double d = distance_squared(p, corner(t[0]), corner(t[1]), corner(t[2]));
            if (d >= best) continue;
            best = d;
            face = run.face;
        }
    });
    return face;
}

}  // namespace coppice::bench
