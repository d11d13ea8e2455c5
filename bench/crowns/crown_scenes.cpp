#include "crown_scenes.h"

#include <array>
#include <cmath>
#include <numbers>
#include <vector>

#include "coppice/growth/radii.h"
#include "coppice/growth/tidy.h"
#include "coppice/implicit/solid/solid_field.h"
#include "coppice/points/sampling/generate.h"

namespace coppice::bench {
namespace {

constexpr double kPointsAtScale1 = 12000;
constexpr float kStep = 0.071f, kInfluence = 1.87f;  // [m]

Vec3 around(double turn, double rise) { return Vec3(Vec3d{std::cos(turn), std::sin(turn), rise}); }

Solid leaf_cluster(int number, Vec3 at, float size) {
    const PrimitiveOptions o{.radius = size};
    const Vec3 out = normalized(around(2.4 * number, 0.3)) * size;
    switch (number % 5) {
        case 0:
            return line(at, at + out, o);
        case 1:
            return translated(scaled(sphere({}, o), {1, 1, 0.6f}), at);
        case 2:
            return disc(at, out, size, o);
        case 3:
            return cone(at, at + out * 2, size * 0.5f, 0, o);
        default:
            return sphere(at, o);
    }
}

/// Recursive halves: 2^levels clusters, each half rotated relative to the other by a golden angle.
Solid clusters(int levels, int number, Vec3 at, float size) {
    if (levels == 0) return leaf_cluster(number, at, size * 1.1f);
    std::array<Solid, 2> halves{leaf_cluster(0, at, size), leaf_cluster(0, at, size)};
    for (int half = 0; half < 2; ++half) {
        const double turn = 2.4 * (2 * number + half) + std::numbers::pi * half;
        const Vec3 to = at + around(turn, half == 0 ? 0.5 : -0.4) * size;
        halves[static_cast<std::size_t>(half)] = clusters(levels - 1, 2 * number + half, to, size * 0.84f);
    }
    switch (levels % 3) {
        case 0:
            return ricci_blend(halves, 3);
        case 1:
            return unite(halves);
        default:
            return blend(halves);
    }
}

}  // namespace

Solid crown_blob_tree() {
    const Solid leaves = twisted(clusters(6, 1, {0, 0, 9}, 2), {}, {0, 0, 1}, 0.06f);
    const Solid hollow = line({0, 0, 6}, {0, 0, 10}, {.radius = 0.5f});
    const std::array parts{subtract(leaves, std::span(&hollow, 1)),
                           line({0, 0, 0}, {0, 0, 7}, {.radius = 0.4f})};
    return blend(parts);
}

Solid ball() { return sphere({}, {.radius = 5}); }

PointSet ellipsoid_points(std::size_t count, const Context& ctx) {
    const auto size = static_cast<float>(std::cbrt(static_cast<double>(count) / kPointsAtScale1));
    const Solid solid =
        translated(scaled(sphere({}, {.radius = 1}), Vec3{4, 4, 5} * size), Vec3{0, 0, 6} * size);
    const SolidField field(solid);
    GenerateOptions options;
    options.pattern = PointPattern::uniform;
    options.count = static_cast<int>(count);
    return generate(FieldRef(field), field.surface_bounds(), options, ctx).points;
}

GrowResult grow_in_ellipsoid(const PointSet& points, const Context& ctx) {
    const Root root{{0, 0, 0}, {0, 0, 1}};
    GrowOptions options;
    options.step = kStep;
    options.kill_radius = 2 * kStep;
    options.influence_radius = kInfluence;
    return grow({.attractors = points.positions, .roots = std::span(&root, 1)}, options, ctx);
}

Skeleton dressed(const Skeleton& grown, const Context& ctx) {
    const RadiiOptions radii{.tip_radius = 0.006f};
    return tidy(with_pipe_radii(grown, radii), {}, nullptr, ctx).skeleton;
}

}  // namespace coppice::bench
