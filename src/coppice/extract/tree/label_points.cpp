#include "coppice/extract/tree/label_points.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <vector>

#include "coppice/base/id.h"
#include "coppice/measure/capsule_tree.h"
#include "coppice/skeleton/architecture.h"

namespace coppice {
namespace {

constexpr double kOfRadius = 0.5,
                 // maximum distance of a wood point from the surface, in radii and in spacings
    kSpacings = 0.5;
constexpr std::uint32_t kLastOrder = std::numeric_limits<std::uint8_t>::max();

}  // namespace

void label_points(PointCloud& scan, std::span<const std::uint32_t> which, const ExtractResult& tree,
                  double spacing, const Context& ctx) {
    const std::size_t all = scan.points.size();
    scan.distances.resize(all, std::numeric_limits<float>::quiet_NaN());
    scan.wood.resize(all, 0);
    scan.branch_orders.resize(all, 0);
    scan.evidence.resize(all, 0);
    const CapsuleTree capsules(tree.skeleton, scan.points.origin, ctx);
    const std::vector<std::uint32_t> orders = axis_orders(tree.skeleton);
    const auto place = [&](std::size_t k) { return Vec3d(scan.points.positions[which[k]]); };
    for_each_nearest(
        capsules, ctx, which.size(), place, [&](std::size_t k, const CapsuleTree::Nearest& nearest) {
            if (nearest.capsule == kNoIndex) return;
            const std::uint32_t p = which[k];
            const auto closest = capsules.cone(nearest.capsule).closest_point(place(k));
            const std::size_t node = capsules.node(nearest.capsule).index();
            const double distance = closest.signed_distance();
            scan.distances[p] = static_cast<float>(distance);
            scan.wood[p] = std::abs(distance) <= std::max(kOfRadius * closest.radius, kSpacings * spacing);
            scan.branch_orders[p] = static_cast<std::uint8_t>(std::min(orders[node], kLastOrder));
            scan.evidence[p] = tree.confidence[node].evidence;
        });
}

}  // namespace coppice
