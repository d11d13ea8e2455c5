#pragma once

#include <cmath>
#include <cstdint>
#include <numbers>

#include "coppice/base/random.h"
#include "coppice/points/point_set.h"

namespace coppice {

/// Adds uniformly distributed points on the lateral surface of a cone, with noise along its normals; only on
/// the side that faces +x if `half`.
inline void strew_cone(PointSet& set, Vec3d a, Vec3d b, double ra, double rb, int count, double noise = 0,
                       bool half = false, std::uint64_t seed = 1) {
    const CounterRandom random(seed, 7);
    const Vec3d axis = normalized(b - a), u = perpendicular(axis), v = cross(axis, u);
    std::uint64_t draw = 0;
    for (int i = 0; i < count;) {
        const double t = random.uniform(draw++), turn = random.uniform(draw++, 0, 2 * std::numbers::pi);
        const double off =
            noise * (random.uniform(draw) + random.uniform(draw + 1) + random.uniform(draw + 2) - 1.5);
        draw += 3;
        const Vec3d n = std::cos(turn) * u + std::sin(turn) * v;
        if (half && n.x < 0) continue;
        set.positions.push_back(Vec3(lerp(a, b, t) + n * (std::lerp(ra, rb, t) + off)));
        ++i;
    }
}

/// Returns a stem of 2 m that forks into two branches of 1 m; 4.2 m of branches in total.
inline PointSet fork_cloud(double noise = 0) {
    PointSet set;
    strew_cone(set, {0, 0, 0}, {0, 0, 2}, 0.1, 0.08, 4000, noise, false, 1);
    strew_cone(set, {0, 0, 2}, {0.6, 0, 2.8}, 0.06, 0.05, 1400, noise, false, 2);
    strew_cone(set, {0, 0, 2}, {-0.6, 0.1, 2.8}, 0.06, 0.05, 1400, noise, false, 3);
    return set;
}

}  // namespace coppice
