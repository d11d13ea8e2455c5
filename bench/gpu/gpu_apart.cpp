#include "gpu_apart.h"

#include <algorithm>
#include <cmath>

#include "coppice/base/id.h"
#include "coppice/base/parallel.h"
#include "coppice/measure/capsule_tree.h"

namespace coppice::bench {

float tolerance(Vec3 p, float radius) {
    constexpr float kShare = 1e-4f, kRounding = 4e-7f;
    return kShare * radius + kRounding * (std::abs(p.x) + std::abs(p.y) + std::abs(p.z));
}

std::vector<float> tolerances(std::span<const Vec3> points, const Skeleton& skeleton, const Context& ctx) {
    const CapsuleTree capsules(skeleton, skeleton.origin(), ctx);
    std::vector<float> out(points.size());
    parallel_for(ctx, out.size(), 1024, [&](std::size_t i) {
        const Vec3d p(points[i]);
        const std::uint32_t nearest = capsules.nearest(p).capsule;
        if (nearest != kNoIndex)
            out[i] = tolerance(points[i], static_cast<float>(capsules.cone(nearest).closest_point(p).radius));
    });
    return out;
}

std::int64_t apart(std::span<const Vec3> a, std::span<const Vec3> b, std::span<const float> tolerance) {
    std::int64_t count = 0;
    for (std::size_t i = 0; i < a.size(); ++i) count += !(distance(a[i], b[i]) <= tolerance[i]);
    return count;
}

std::int64_t strays(std::span<const Vec3> a, std::span<const Vec3> b, std::span<const float> tolerance) {
    std::vector<Vec3> sorted(b.begin(), b.end());
    std::ranges::sort(sorted, {}, &Vec3::x);
    std::int64_t count = 0;
    for (std::size_t i = 0; i < a.size(); ++i) {
        auto near = std::ranges::lower_bound(sorted, a[i].x - tolerance[i], {}, &Vec3::x);
        const auto is_there = [&] { return distance(*near, a[i]) <= tolerance[i]; };
        while (near != sorted.end() && near->x <= a[i].x + tolerance[i] && !is_there()) ++near;
        count += near == sorted.end() || near->x > a[i].x + tolerance[i];
    }
    return count;
}

}  // namespace coppice::bench
