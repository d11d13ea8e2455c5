#include "coppice/compose/composed_tree_internal.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "coppice/base/error.h"
#include "coppice/base/id.h"
#include "coppice/base/median.h"
#include "coppice/skeleton/pipe_model.h"

namespace coppice::compose_internal {
namespace {

// [radii of the parent branch] distance from a branch node within which branches always overlap
constexpr double kNear = 2;

}  // namespace

ComposedTree::ComposedTree(const Skeleton& template_tree, const ComposeOptions& options)
    : origin_(template_tree.origin()),
      clearance_(double{options.clearance}),
      max_nodes_(static_cast<std::uint32_t>(options.max_nodes)) {
    const BranchSizes sizes(template_tree);
    for (const coppice::NodeId n : coppice::nodes(template_tree)) {
        const std::uint32_t i = n.index(),
                            parent = template_tree.is_root(n) ? kNoIndex : template_tree.parent(n).index();
        const bool begins = parent != kNoIndex && template_tree.leader(template_tree.parent(n)) != n;
        add({.parent = parent,
             .position = template_tree.position(n),
             .radius = template_tree.radius(n),
             .order = parent == kNoIndex ? 0 : nodes_[parent].order + (begins ? 1 : 0),
             .orders = sizes.orders[i],
             .length = sizes.length[i]});
    }
    for (std::uint32_t n = 0; n < size(); ++n) place_segment(n);
}

std::uint32_t ComposedTree::add(Node node) {
    const std::uint32_t n = size();
    node.child = node.next = kNoIndex;
    nodes_.push_back(node);
    if (node.parent == kNoIndex) return n;
    std::uint32_t* link = &nodes_[node.parent].child;
    while (*link != kNoIndex) link = &nodes_[*link].next;
    *link = n;
    return n;
}

// A segment that begins at a branch node has its own radius there, as in a Skeleton. A leader has the radius
// of the parent branch there; the difference matters only near the node, where intersections are ignored.
void ComposedTree::place_segment(std::uint32_t n) {
    const Node& node = nodes_[n];
    if (clearance_ <= 0 || node.parent == kNoIndex) return;
    const Node& from = nodes_[node.parent];
    const double first = from.child == n && node.next == kNoIndex ? double{from.radius} : double{node.radius};
    const RoundCone cone = round_cone(Vec3d(from.position), Vec3d(node.position), first, double{node.radius});
    const double most = clearance_ * std::max(first, double{node.radius});
    segments_.add(n, cone, capsule_box(from.position, node.position, static_cast<float>(most)));
}

void ComposedTree::children(std::uint32_t n, std::vector<std::uint32_t>& out) const {
    out.clear();
    for (std::uint32_t c = nodes_[n].child; c != kNoIndex; c = nodes_[c].next) {
        if (!nodes_[c].gone) out.push_back(c);
    }
}

std::uint32_t ComposedTree::leader(std::uint32_t n) const {
    std::uint32_t best = kNoIndex;
    for (std::uint32_t c = nodes_[n].child; c != kNoIndex; c = nodes_[c].next) {
        if (!nodes_[c].gone && (best == kNoIndex || nodes_[c].radius > nodes_[best].radius)) best = c;
    }
    return best;
}

Place ComposedTree::place(std::uint32_t node, std::uint32_t first) const {
    const Node& at = nodes_[node];
    Place out{.node = node, .first = first};
    out.position = Vec3d(at.position);
    out.radius = double{at.radius};
    out.first_radius = double{nodes_[first].radius};
    out.length = nodes_[first].length;
    const auto direction_to = [&](std::uint32_t next_node, const auto& next) {
        return direction_along(
            out.position, next_node, kReach * out.radius,
            [&](std::uint32_t n) { return Vec3d(nodes_[n].position); }, next, kNoIndex);
    };
    out.direction = direction_to(first, [&](std::uint32_t n) { return leader(n); });
    out.parent_direction = at.parent == kNoIndex
                               ? kUp
                               : -direction_to(at.parent, [&](std::uint32_t n) { return nodes_[n].parent; });
    for (std::uint32_t c = at.child; c != kNoIndex; c = nodes_[c].next) {
        if (nodes_[c].gone) continue;
        out.node_length += nodes_[c].length;
        if (c != first) out.thickest_sibling = std::max(out.thickest_sibling, double{nodes_[c].radius});
    }
    out.leads = leader(node) == first;
    return out;
}

bool ComposedTree::crosses(const Place& place, const Skeleton& tree, std::span<const Vec3> positions,
                           std::span<const float> radii) {
    if (clearance_ <= 0) return false;
    Box3 all;
    for (std::size_t i = 0; i < positions.size(); ++i)
        all.extend(Box3{positions[i], positions[i]}.inflated(static_cast<float>(clearance_) * radii[i]));
    segments_.look_within(all);
    bool found = false;
    for (std::uint32_t i = 1; i < tree.size() && !found; ++i) {
        const std::uint32_t p = tree.parent(NodeId(i)).index();
        const double ra = double{radii[i == 1 ? 1 : p]}, rb = double{radii[i]};
        const Vec3d a(positions[p]), b(positions[i]);
        const double most = clearance_ * std::max(ra, rb);
        const Box3 box = capsule_box(positions[p], positions[i], static_cast<float>(most));
        segments_.visit_overlapping(box, [&](std::uint32_t n, const RoundCone& cone) {
            if (nodes_[n].gone) return true;
            const ClosestParameters at = closest_parameters(a, b, cone.a, cone.b());
            const Vec3d here = lerp(a, b, at.on_a);
            const double apart = distance(here, cone.point(at.on_b));
            const double least = clearance_ * (std::lerp(ra, rb, at.on_a) + cone.radius(at.on_b));
            found = apart < least && !(distance(here, place.position) < kNear * place.radius &&
                                       std::ranges::binary_search(at_node_, n));
            return !found;
        });
    }
    return found;
}

void ComposedTree::find_axes_at(const Place& place) {
    at_node_.clear();
    const auto is_near = [&](std::uint32_t n) {
        return distance(Vec3d(nodes_[n].position), place.position) < kNear * place.radius;
    };
    for (std::uint32_t n = place.node; nodes_[n].parent != kNoIndex; n = nodes_[n].parent) {
        at_node_.push_back(n);
        if (!is_near(nodes_[n].parent)) break;
    }
    for (std::uint32_t c = nodes_[place.node].child; c != kNoIndex; c = nodes_[c].next) {
        if (nodes_[c].gone) continue;
        for (std::uint32_t n = c; n != kNoIndex; n = is_near(n) ? leader(n) : kNoIndex) at_node_.push_back(n);
    }
    std::ranges::sort(at_node_);
}

void ComposedTree::take_out(const Place& place) {
    taken_.assign(1, place.first);
    for (std::size_t i = 0; i < taken_.size(); ++i) {
        nodes_[taken_[i]].gone = true;
        for (std::uint32_t c = nodes_[taken_[i]].child; c != kNoIndex; c = nodes_[c].next) {
            if (!nodes_[c].gone) taken_.push_back(c);
        }
    }
    find_axes_at(place);
}

void ComposedTree::put_back() {
    for (const std::uint32_t n : taken_) nodes_[n].gone = false;
}

void ComposedTree::put_in(const Place& place, const Skeleton& tree, std::span<const double> length,
                          std::span<const std::uint32_t> orders, std::span<const Vec3> positions,
                          std::span<const float> radii) {
    if (size() + tree.size() > max_nodes_) {
        throw InvalidInput(
            fmt::format("compose: the tree gets more than {} nodes; use a smaller library, depth or "
                        "tolerance, or raise the limit of nodes",
                        max_nodes_));
    }
    const std::uint32_t before = size() - 1, depth = nodes_[place.node].depth + 1;
    const std::uint32_t order = nodes_[place.node].order + (place.leads ? 0 : 1);
    for (std::uint32_t i = 1; i < tree.size(); ++i) {
        const NodeId n(i), p = tree.parent(n);
        const bool begins = i > 1 && tree.leader(p) != n;
        const std::uint32_t parent = i == 1 ? place.node : before + p.index();
        add({.parent = parent,
             .position = positions[i],
             .radius = radii[i],
             .order = i == 1 ? order : nodes_[parent].order + (begins ? 1 : 0),
             .orders = orders[i],
             .depth = depth,
             .length = length[i]});
    }
    for (std::uint32_t n = before + 1; n < size(); ++n) place_segment(n);
}

Skeleton ComposedTree::skeleton(const ComposeOptions& options) const {
    std::vector<std::uint32_t> number(size(), kNoIndex);
    std::vector<NodeId> parents;
    std::vector<Vec3> positions;
    std::vector<float> radii;
    std::vector<double> tips;
    for (std::uint32_t n = 0; n < size(); ++n) {
        const Node& node = nodes_[n];
        if (node.gone) continue;
        number[n] = static_cast<std::uint32_t>(parents.size());
        parents.push_back(node.parent == kNoIndex ? NodeId::none() : NodeId(number[node.parent]));
        positions.push_back(node.position);
        radii.push_back(node.radius);
        if (leader(n) == kNoIndex) tips.push_back(double{node.radius});
    }
    if (options.radii == ComposeRadii::pipes) {
        const std::vector<double> pipes =
            pipe_radii(parents, median_in_place(tips), double{options.pipe_exponent}, 0);
        std::ranges::transform(pipes, radii.begin(), [](double r) { return static_cast<float>(r); });
    }
    return {std::move(parents), std::move(positions), std::move(radii), origin_};
}

}  // namespace coppice::compose_internal
