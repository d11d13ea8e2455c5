#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "coppice/base/error.h"
#include "coppice/base/frame.h"
#include "coppice/base/median.h"
#include "coppice/foliage/shoots_internal.h"

namespace coppice::foliage_internal {
namespace {

constexpr double kMaxLeaves = 20e6;

float find_max_radius(const Skeleton& s, const LeafRules& rules) {
    if (rules.max_radius > 0) return rules.max_radius;
    std::vector<float> tips;
    for (const NodeId n : nodes(s)) {
        if (s.is_tip(n)) tips.push_back(s.radius(n));
    }
    return 2 * median_in_place(tips);
}

/// Returns the nodes of a branch from its tip to its first node.
std::vector<NodeId> list_from_tip(const BranchTable& table, const Branch& branch) {
    std::vector<NodeId> out;
    for (NodeId n = branch.first; n; n = table.next_of[n.index()]) out.push_back(n);
    std::ranges::reverse(out);
    return out;
}

/// Returns the length of the end of a branch that is thin enough for leaves.
float measure_leafy_length(const Skeleton& s, const std::vector<NodeId>& chain, float max_radius,
                           float max_length) {
    float length = 0;
    for (const NodeId n : chain) {
        if (s.is_root(n) || s.radius(n) > max_radius || length >= max_length) break;
        const Segment segment = s.segment(n);
        const float l = distance(segment.a, segment.b);
        const bool ends = segment.radius_a > max_radius;
        const float share =
            ends ? (max_radius - segment.radius_b) / (segment.radius_a - segment.radius_b) : 1.0f;
        length += share * l;
        if (ends) break;
    }
    return std::min(length, max_length);
}

/// Returns the distance of place k of n from the tip per length of the shoot.
float find_share(const Shoot& shoot, const LeafRules& rules, std::uint32_t k) {
    if (k == 0) return 0;
    const float pitch = rules.internode * (shoot.length > 0 ? 1 / shoot.length : 0);
    const float even = std::min(1.0f, static_cast<float>(k) * pitch);
    return std::pow(even, 1 + 2 * rules.clustering);
}

}  // namespace

std::uint32_t count_leaves_per_node(const LeafRules& rules) {
    switch (rules.arrangement) {
        case LeafArrangement::spiral:
        case LeafArrangement::two_ranked:
            return 1;
        case LeafArrangement::opposite:
            return 2;
        case LeafArrangement::whorled:
            return static_cast<std::uint32_t>(rules.whorl);
    }
    return 1;
}

ShootTable find_shoots(const Skeleton& skeleton, const LeafRules& rules) {
    ShootTable out{.table = list_branches(skeleton), .max_radius = find_max_radius(skeleton, rules)};
    const auto per_node = static_cast<std::size_t>(count_leaves_per_node(rules));
    double count = 0;
    for (std::uint32_t b = 0; b < out.table.branches.size(); ++b) {
        const Branch& branch = out.table.branches[b];
        if (branch.segments == 0 || branch.order < static_cast<std::uint32_t>(rules.min_order)) continue;
        const std::vector<NodeId> chain = list_from_tip(out.table, branch);
        if (skeleton.radius(chain.front()) > out.max_radius) {
            ++out.thick_tips;
            continue;
        }
        Shoot shoot{.branch = b, .first = out.leaf_count};
        shoot.length = measure_leafy_length(skeleton, chain, out.max_radius, rules.shoot_length);
        const float places = shoot.length / rules.internode;
        count += (1 + std::floor(double{places})) * static_cast<double>(per_node);
        if (count > kMaxLeaves)
            throw InvalidInput(fmt::format(
                "leaves: there are more than {:.0f} million leaves; increase internode, or reduce "
                "shoot_length or max_radius",
                kMaxLeaves / 1e6));
        shoot.nodes = 1 + static_cast<std::uint32_t>(places);
        out.leaf_count += shoot.nodes * per_node;
        out.shoots.push_back(shoot);
    }
    return out;
}

std::vector<ShootPlace> find_places(const Skeleton& skeleton, const ShootTable& table, const Shoot& shoot,
                                    const LeafRules& rules) {
    const std::vector<NodeId> chain = list_from_tip(table.table, table.table.branches[shoot.branch]);
    std::vector<ShootPlace> out;
    out.reserve(shoot.nodes);
    Vec3d axis, normal;
    float passed = 0;
    for (std::size_t i = 0; i < chain.size() && out.size() < shoot.nodes; ++i) {
        if (skeleton.is_root(chain[i])) break;
        const Segment s = skeleton.segment(chain[i]);
        const float length = distance(s.a, s.b);
        const Vec3d direction = normalized(Vec3d(s.b) - Vec3d(s.a), axis == Vec3d{} ? Vec3d{0, 0, 1} : axis);
        // Leaves in two ranks are level where the axis allows.
        normal = i == 0 ? normalized(cross(Vec3d{0, 0, 1}, direction), perpendicular(direction))
                        : normalized(turned(normal, axis, direction), perpendicular(direction));
        axis = direction;
        while (out.size() < shoot.nodes) {
            const float share = find_share(shoot, rules, static_cast<std::uint32_t>(out.size()));
            const float at = share * shoot.length - passed;
            if (at > length && i + 1 < chain.size() && !skeleton.is_root(chain[i + 1])) break;
            const float f = length > 0 ? std::clamp(at / length, 0.0f, 1.0f) : 0.0f;
            out.push_back({.center = lerp(s.b, s.a, f),
                           .axis = Vec3(axis),
                           .normal = Vec3(normal),
                           .radius = s.radius_b + (s.radius_a - s.radius_b) * f,
                           .from_tip = share,
                           .node = chain[i]});
        }
        passed += length;
    }
    return out;
}

}  // namespace coppice::foliage_internal
