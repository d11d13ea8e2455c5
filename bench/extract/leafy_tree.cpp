#include "leafy_tree.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>

#include "coppice/base/error.h"
#include "coppice/base/parallel.h"
#include "coppice/measure/surface_tree.h"
#include "coppice/pipeline/mesh_skeleton.h"
#include "coppice/render/scan.h"
#include "coppice/skeleton/measure.h"
#include "draws.h"
#include "face_at.h"

namespace coppice::bench {
namespace {

constexpr std::uint64_t kSeed = 5;

/// Adds a blade of eight triangles around its midrib, from its base along a direction.
void add_leaf(PolygonMesh& mesh, Vec3d base, Vec3d along, Vec3d up, double size, Draws& draws) {
    const double width = size * draws.uniform(0.45, 0.7);
    const double fold = draws.uniform(0, 0.35), bend = draws.uniform(0, 0.3);
    const Vec3d side = normalized(cross(up, along));
    const Vec3d over = cross(along, side);
    constexpr std::array<std::array<double, 2>, 8> kCorners{
        {{0, 0}, {0.35, 1}, {0.35, 0}, {0.35, -1}, {0.75, 0.75}, {0.75, 0}, {0.75, -0.75}, {1, 0}}};
    constexpr std::array<Triangle, 8> kFaces{
        {{0, 1, 2}, {0, 2, 3}, {1, 4, 5}, {1, 5, 2}, {2, 5, 6}, {2, 6, 3}, {4, 7, 5}, {5, 7, 6}}};
    const auto first = static_cast<std::uint32_t>(mesh.positions.size());
    for (const auto& [t, s] : kCorners) {
        mesh.positions.push_back(Vec3(base + along * (t * size) + side * (s * width / 2) +
                                      over * (fold * std::abs(s) * width / 2 - bend * t * t * size)));
    }
    for (const Triangle& f : kFaces) mesh.add_face(std::array{first + f[0], first + f[1], first + f[2]});
}

}  // namespace

Foliage foliage_named(const std::string& name) {
    if (name == "none") return {};
    if (name == "sparse") return {0.02, 40, 0.08};
    if (name == "usual") return {0.025, 150, 0.06};
    if (name == "dense") return {0.03, 400, 0.07};
    throw InvalidInput(fmt::format("foliage must be none, sparse, usual or dense, but is '{}'", name));
}

double LeafyScan::leaf_share() const {
    return static_cast<double>(std::ranges::count(leaf, 1)) / static_cast<double>(leaf.size());
}

void add_foliage(PolygonMesh& mesh, const Skeleton& tree, const Foliage& foliage) {
    Draws draws(kSeed, 99);
    for (const NodeId n : nodes(tree)) {
        if (tree.is_root(n) || tree.radius(n) > foliage.thickest) continue;
        const Segment s = tree.segment(n);
        const Vec3d a(s.a), d = Vec3d(s.b) - a, axis = normalized(d);
        const int count = static_cast<int>(foliage.density * length(d) + draws.uniform(0, 1));
        for (int i = 0; i < count; ++i) {
            const Vec3d at = a + d * draws.uniform(0, 1);
            Vec3d away = normalized(Vec3d{draws.normal(), draws.normal(), draws.normal()});
            away = normalized(away - axis * (0.7 * dot(away, axis)));
            const Vec3d up =
                normalized(Vec3d{0.7 * draws.normal(), 0.7 * draws.normal(), 0.3 + draws.normal()});
            const double size = foliage.size * draws.uniform(0.7, 1.3);
            const Vec3d base = at + away * (tree.radius(n) + size * draws.uniform(0.15, 0.5));
            add_leaf(mesh, base, normalized(away - Vec3d{0, 0, 0.3}), up, size, draws);
        }
    }
}

LeafyScan scan_leafy_tree(const Skeleton& tree, const Foliage& foliage, int points, const Context& ctx) {
    PolygonMesh mesh = to_polygons(mesh_skeleton(tree, {}, ctx).quads().mesh);
    const std::uint32_t wood_faces = mesh.face_count();
    add_foliage(mesh, tree, foliage);
    const ScanOptions options{.points = points,
                              .positions = 4,
                              .distance = static_cast<float>(0.9 * measure(tree).bounds.diagonal()),
                              .noise = 0.002f,
                              .seed = 3};
    LeafyScan out{scan(mesh, options, ctx), {}};
    const SurfaceTree surface(mesh, ctx);
    out.leaf.resize(out.points.size());
    parallel_for(ctx, out.points.size(), 1024, [&](std::size_t i) {
        out.leaf[i] = face_at(surface, Vec3d(out.points.positions[i])) >= wood_faces;
    });
    return out;
}

}  // namespace coppice::bench
