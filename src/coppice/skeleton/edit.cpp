#include "coppice/skeleton/edit_internal.h"

#include <fmt/format.h>

#include <algorithm>
#include <utility>

#include "coppice/base/error.h"
#include "coppice/skeleton/chains_internal.h"

namespace coppice {
namespace {

/// Returns whether a node is inside an axis: it continues the axis of its parent and has a leader.
bool is_inside_axis(const Skeleton& s, NodeId n) {
    return !s.is_root(n) && !s.is_tip(n) && s.leader(s.parent(n)) == n;
}

bool still_leads(const Skeleton& s, NodeId n, float radius) {
    return std::ranges::all_of(s.children(s.parent(n)), [&](NodeId c) {
        return c == n || s.radius(c) < radius || (s.radius(c) == radius && n < c);
    });
}

std::vector<float> averaged(const Skeleton& s, const std::vector<float>& radius) {
    std::vector<float> smooth = radius;
    for (const NodeId n : nodes(s)) {
        if (!is_inside_axis(s, n)) continue;
        const float around = radius[s.parent(n).index()] + radius[s.leader(n).index()];
        const float r = 0.5f * radius[n.index()] + 0.25f * around;
        // Only the radii of leaders change, so the siblings have the radii of s.
        if (still_leads(s, n, r)) smooth[n.index()] = r;
    }
    return smooth;
}

/// Merges each branch node that is too close to the next branch node towards the root into that one.
class Merger {
  public:
    Merger(const Skeleton& s, float factor)
        : s_(s),
          factor_(factor),
          kept_(s.size(), true),
          branch_(s.size()),
          position_(s.positions().begin(), s.positions().end()),
          radius_(s.radii().begin(), s.radii().end()) {}

    EditResult run() {
        std::uint32_t count = 0;
        for (const NodeId n : nodes(s_)) {
            const NodeId ancestor = s_.is_root(n) ? NodeId::none() : branch_[s_.parent(n).index()];
            branch_[n.index()] = ancestor;
            if (s_.children(n).size() < 2) continue;
            if (ancestor && close(ancestor, n)) {
                merge(ancestor, n);
                ++count;
            } else {
                branch_[n.index()] = n;
            }
        }
        if (count == 0) return {s_, 0, all_nodes(s_)};
        Subset subset = take_nodes(s_, kept_, position_, radius_);
        for (const NodeId n : merged_) {
            subset.new_of_old[n.index()] = subset.new_of_old[branch_[n.index()].index()];
        }
        return {std::move(subset.skeleton), count, std::move(subset.new_of_old)};
    }

  private:
    bool close(NodeId a, NodeId b) const {
        const float room = factor_ * std::max(radius_[a.index()], radius_[b.index()]);
        return distance(position_[a.index()], position_[b.index()]) < room;
    }

    void merge(NodeId ancestor, NodeId n) {
        if (radius_[n.index()] > radius_[ancestor.index()]) {
            position_[ancestor.index()] = position_[n.index()];
            radius_[ancestor.index()] = radius_[n.index()];
        }
        for (NodeId i = n; kept_[i.index()] && i != ancestor; i = s_.parent(i)) {
            kept_[i.index()] = false;
            merged_.push_back(i);
        }
    }

    const Skeleton& s_;
    float factor_;
    std::vector<bool> kept_;
    std::vector<NodeId> branch_;  // branch node into which a node is merged, or the next one towards the root
    std::vector<NodeId> merged_;
    std::vector<Vec3> position_;
    std::vector<float> radius_;
};

/// Returns the children in order of their direction: backward ones first, the leader last.
std::vector<NodeId> in_leaving_order(const Skeleton& s, NodeId n) {
    const NodeId leader = s.leader(n);
    const Vec3 forward = normalized(s.position(leader) - s.position(n));
    std::vector<std::pair<float, NodeId>> keyed;
    for (const NodeId c : s.children(n)) {
        if (c != leader) keyed.emplace_back(dot(forward, normalized(s.position(c) - s.position(n))), c);
    }
    std::sort(keyed.begin(), keyed.end());
    std::vector<NodeId> order;
    for (const auto& [along, child] : keyed) order.push_back(child);
    order.push_back(leader);
    return order;
}

}  // namespace

EditResult smooth_radii(const Skeleton& skeleton, int passes) {
    std::vector<float> radius(skeleton.radii().begin(), skeleton.radii().end());
    for (int pass = 0; pass < passes; ++pass) radius = averaged(skeleton, radius);
    std::uint32_t count = 0;
    for (const NodeId n : nodes(skeleton)) count += radius[n.index()] != skeleton.radius(n);
    return {Skeleton({skeleton.parents().begin(), skeleton.parents().end()},
                     {skeleton.positions().begin(), skeleton.positions().end()}, std::move(radius),
                     skeleton.origin()),
            count, all_nodes(skeleton)};
}

EditResult merge_close_branches(const Skeleton& skeleton, float factor) {
    return Merger(skeleton, factor).run();
}

EditResult split_crowded_nodes(const Skeleton& skeleton, int max_children) {
    if (max_children < 2) {
        throw InvalidInput(
            fmt::format("a node cannot be limited to {} children; allow at least 2", max_children));
    }
    const auto most = static_cast<std::size_t>(max_children);
    std::vector<NodeId> parent, image(skeleton.size()), from(skeleton.size());
    std::vector<Vec3> position;
    std::vector<float> radius;
    const auto add = [&](NodeId p, Vec3 at, float r) {
        parent.push_back(p);
        position.push_back(at);
        radius.push_back(r);
        return NodeId(static_cast<std::uint32_t>(parent.size() - 1));
    };
    for (const NodeId n : nodes(skeleton)) {
        NodeId last = image[n.index()] = add(from[n.index()], skeleton.position(n), skeleton.radius(n));
        const std::size_t children = skeleton.children(n).size();
        if (children <= most) {
            for (const NodeId c : skeleton.children(n)) from[c.index()] = last;
            continue;
        }
        const std::vector<NodeId> order = in_leaving_order(skeleton, n);
        const Segment way = skeleton.segment(order.back());
        // Every node except the last uses one of its child slots for the next one.
        const std::size_t added = (children - 2) / (most - 1);
        const float l = distance(way.a, way.b);
        const float part = l > 0 ? std::min(way.radius_a / l, 0.5f / static_cast<float>(added)) : 0;
        std::size_t next = 0;
        for (std::size_t k = 0; k <= added; ++k) {
            const float t = part * static_cast<float>(k);
            const float r = std::max(way.radius_a + t * (way.radius_b - way.radius_a), way.radius_b);
            if (k > 0) last = add(last, lerp(way.a, way.b, t), r);
            const std::size_t end = k < added ? next + most - 1 : children;
            for (; next < end; ++next) from[order[next].index()] = last;
        }
    }
    const auto count = static_cast<std::uint32_t>(parent.size()) - skeleton.size();
    return {Skeleton(std::move(parent), std::move(position), std::move(radius), skeleton.origin()), count,
            std::move(image)};
}

}  // namespace coppice
