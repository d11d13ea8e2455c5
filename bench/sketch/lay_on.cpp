#include "lay_on.h"

#include <Eigen/Geometry>
#include <Eigen/LU>
#include <algorithm>
#include <cmath>
#include <limits>
#include <vector>

#include "coppice/base/kernel/segment_distance.h"
#include "coppice/skeleton/raw.h"

namespace coppice::bench {
namespace {

constexpr int kSteps = 12;

Eigen::Vector3d eigen(Vec3d v) { return {v.x, v.y, v.z}; }

Vec3d moved(const Eigen::Matrix4d& by, Vec3d p) {
    const Eigen::Vector3d q = by.topLeftCorner<3, 3>() * eigen(p) + by.topRightCorner<3, 1>();
    return {q.x(), q.y(), q.z()};
}

Vec3d world(const Skeleton& skeleton, NodeId n) { return skeleton.origin() + Vec3d(skeleton.position(n)); }

Vec3d nearest(const Skeleton& skeleton, Vec3d p) {
    Vec3d best;
    double least = std::numeric_limits<double>::infinity();
    for (const NodeId n : nodes(skeleton)) {
        if (skeleton.is_root(n)) continue;
        const Vec3d a = world(skeleton, skeleton.parent(n)), d = world(skeleton, n) - a;
        const Vec3d q = a + d * closest_parameter(p, a, d);
        if (const double off = distance(p, q); off < least) least = off, best = q;
    }
    return best;
}

}  // namespace

Skeleton laid_on(const Skeleton& reference, const Skeleton& found) {
    Eigen::Matrix4d there = Eigen::Matrix4d::Identity();  // from the reference to the result
    for (int step = 0; step < kSteps; ++step) {
        struct Pair {
            Vec3d from, to;
            double off;
        };
        std::vector<Pair> pairs;
        for (const NodeId n : nodes(reference)) {
            const Vec3d p = world(reference, n), q = moved(there, p), closest = nearest(found, q);
            pairs.push_back({p, closest, distance(q, closest)});
        }
        std::ranges::sort(pairs, {}, &Pair::off);
        pairs.resize(pairs.size() * 4 / 5);
        const auto count = static_cast<Eigen::Index>(pairs.size());
        Eigen::Matrix3Xd from(3, count), to(3, count);
        for (Eigen::Index i = 0; i < count; ++i) {
            from.col(i) = eigen(pairs[static_cast<std::size_t>(i)].from);
            to.col(i) = eigen(pairs[static_cast<std::size_t>(i)].to);
        }
        there = Eigen::umeyama(from, to, true);
    }
    const Eigen::Matrix4d back = there.inverse();
    const double scale = std::cbrt(back.topLeftCorner<3, 3>().determinant());
    std::vector<RawNode> raw;
    for (const NodeId n : nodes(found)) {
        const std::int64_t parent =
            found.is_root(n) ? -1 : static_cast<std::int64_t>(found.parent(n).index());
        raw.push_back({.id = static_cast<std::int64_t>(n.index()),
                       .parent = parent,
                       .position = moved(back, world(found, n)),
                       .radius = scale * double{found.radius(n)}});
    }
    return repair(raw, "laid on").skeleton;
}

}  // namespace coppice::bench
