#include "coppice/skeleton/assemble.h"

#include <fmt/format.h>

#include <cmath>
#include <utility>
#include <vector>

#include "coppice/base/error.h"
#include "coppice/base/rotation.h"

namespace coppice {
namespace {

/// Returns the tree with transformed nodes; `place` maps positions in world space.
template <class Place>
Skeleton moved(const Skeleton& s, double factor, const Place& place) {
    std::vector<Vec3> positions;
    std::vector<float> radii;
    for (const NodeId n : nodes(s)) {
        positions.emplace_back(place(Vec3d(s.position(n)) + s.origin()) - s.origin());
        radii.push_back(static_cast<float>(s.radius(n) * factor));
    }
    return Skeleton({s.parents().begin(), s.parents().end()}, std::move(positions), std::move(radii),
                    s.origin(), {s.stable_ids().begin(), s.stable_ids().end()});
}

}  // namespace

Skeleton translated(const Skeleton& skeleton, Vec3d by) {
    return moved(skeleton, 1, [&](Vec3d p) { return p + by; });
}

Skeleton rotated(const Skeleton& skeleton, Vec3d axis, double angle, Vec3d center) {
    if (!(length(axis) > 0)) throw InvalidInput("the axis needs a direction, but is 0,0,0");
    const Rotation turn = rotation_about(normalized(axis), angle);
    return moved(skeleton, 1, [&](Vec3d p) { return center + turn(p - center); });
}

Skeleton scaled(const Skeleton& skeleton, double factor, Vec3d center) {
    if (!(factor > 0) || !std::isfinite(factor))
        throw InvalidInput(fmt::format("a skeleton is scaled by one factor greater than 0, not {}", factor));
    return moved(skeleton, factor, [&](Vec3d p) { return center + (p - center) * factor; });
}

Skeleton joined(std::span<const Skeleton* const> parts) {
    COPPICE_ASSERT(!parts.empty());
    const Vec3d origin = parts.front()->origin();
    std::vector<NodeId> parents;
    std::vector<Vec3> positions;
    std::vector<float> radii;
    for (const Skeleton* part : parts) {
        const auto first = static_cast<std::uint32_t>(parents.size());
        const Vec3d shift = part->origin() - origin;
        for (const NodeId n : nodes(*part)) {
            const NodeId parent = part->parent(n);
            parents.push_back(parent ? NodeId(first + parent.index()) : NodeId::none());
            positions.emplace_back(Vec3d(part->position(n)) + shift);
            radii.push_back(part->radius(n));
        }
    }
    return Skeleton(std::move(parents), std::move(positions), std::move(radii), origin);
}

}  // namespace coppice
