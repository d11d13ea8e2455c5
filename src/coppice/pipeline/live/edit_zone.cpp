#include <algorithm>
#include <deque>

#include "coppice/pipeline/live/edit_zone_internal.h"
#include "coppice/spatial/box_tree.h"

namespace coppice::pipeline_internal {
namespace {

constexpr float kInfluence = 2;          // [radii] distance within which a segment influences others
constexpr std::uint8_t kBeyond = 2;      // levels beyond the trusted ones
constexpr std::uint32_t kMinWhole = 64;  // minimum number of nodes of a tree for a zone
constexpr float kMaxOfTree = 0.6f;

Box3 influence_box(const Skeleton& s, NodeId n) { return box_about(s, n, kInfluence); }

// Calls visit(n) for a node and those with segments that share an end with its segment: parent, children and
// siblings.
template <class Visit>
void visit_around(const Skeleton& s, NodeId n, const Visit& visit) {
    visit(n);
    for (const NodeId c : s.children(n)) visit(c);
    if (s.is_root(n)) return;
    visit(s.parent(n));
    for (const NodeId c : s.children(s.parent(n))) visit(c);
}

// Lowers the levels of nodes with segments near any of the boxes.
void mark_near(const Skeleton& s, std::span<const Box3> boxes, std::uint8_t level,
               std::vector<std::uint8_t>& levels, const Context& ctx) {
    if (boxes.empty()) return;
    Box3 all;
    for (const Box3& b : boxes) all.extend(b);
    const BoxTree tree(boxes, ctx);
    for (const NodeId n : nodes(s)) {
        if (levels[n.index()] <= level) continue;
        const Box3 box = influence_box(s, n);
        if (box.overlaps(all) && tree.meets(box)) levels[n.index()] = level;
    }
}

// Spreads levels along the tree, up to the last; the level increases by one beyond each branch node.
void spread(const Skeleton& s, std::uint8_t last, std::vector<std::uint8_t>& levels) {
    std::deque<NodeId> queue;
    for (const NodeId n : nodes(s)) {
        if (levels[n.index()] <= last) queue.push_back(n);
    }
    std::ranges::stable_sort(queue, {}, [&](NodeId n) { return levels[n.index()]; });
    const auto degree = [&](NodeId n) { return s.children(n).size() + (s.is_root(n) ? 0 : 1); };
    while (!queue.empty()) {
        const NodeId n = queue.front();
        queue.pop_front();
        const std::uint8_t level = levels[n.index()];
        const bool is_fork = degree(n) > 2;
        const auto reach = [&](NodeId to) {
            // A segment within the ball of a branch node may become part of it.
            const bool passes = is_fork && distance(s.position(n), s.position(to)) > s.radius(n);
            const int next = level + (passes ? 1 : 0);
            if (next > last || next >= levels[to.index()]) return;
            levels[to.index()] = static_cast<std::uint8_t>(next);
            if (passes) {
                queue.push_back(to);
            } else {
                queue.push_front(to);
            }
        };
        if (!s.is_root(n)) reach(s.parent(n));
        for (const NodeId c : s.children(n)) reach(c);
    }
}

std::vector<Box3> boxes_up_to(const Skeleton& s, std::span<const std::uint8_t> levels, std::uint8_t last) {
    std::vector<Box3> out;
    for (const NodeId n : nodes(s)) {
        if (levels[n.index()] <= last) out.push_back(influence_box(s, n));
    }
    return out;
}

// Returns the nodes of the zone, those between them and the roots, and the children of all these.
std::vector<std::uint8_t> with_ways_and_children(const Skeleton& s, std::span<const std::uint8_t> levels) {
    std::vector<std::uint8_t> inner(s.size(), 0);
    for (const NodeId n : nodes(s)) {
        if (levels[n.index()] == EditZone::kFar) continue;
        for (NodeId m = n; m && inner[m.index()] == 0; m = s.parent(m)) inner[m.index()] = 1;
    }
    std::vector<std::uint8_t> out = inner;
    for (const NodeId n : nodes(s)) {
        if (!s.is_root(n) && inner[s.parent(n).index()] != 0) out[n.index()] = 1;
    }
    return out;
}

Skeleton part_of_tree(const Skeleton& s, std::span<const std::uint8_t> is_in) {
    std::vector<NodeId> place(s.size()), parent;
    std::vector<Vec3> position;
    std::vector<float> radius;
    std::vector<StableId> id;
    for (const NodeId n : nodes(s)) {
        if (is_in[n.index()] == 0) continue;
        place[n.index()] = NodeId(static_cast<std::uint32_t>(parent.size()));
        parent.push_back(s.is_root(n) ? NodeId::none() : place[s.parent(n).index()]);
        position.push_back(s.position(n));
        radius.push_back(s.radius(n));
        id.push_back(s.stable_id(n));
    }
    return {std::move(parent), std::move(position), std::move(radius), s.origin(), std::move(id)};
}

}  // namespace

Box3 box_about(const Skeleton& s, NodeId n, float radii) {
    if (s.is_root(n)) return capsule_box(s.position(n), s.position(n), radii * s.radius(n));
    const Segment g = s.segment(n);
    return capsule_box(g.a, g.b, radii * std::max(g.radius_a, g.radius_b));
}

NodeIndex::NodeIndex(const Skeleton& s) {
    std::uint32_t most = 0;
    for (const NodeId n : nodes(s)) most = std::max(most, s.stable_id(n).index());
    node_.resize(std::size_t{most} + 1);
    for (const NodeId n : nodes(s)) node_[s.stable_id(n).index()] = n;
}

Touched touched_by(std::span<const StableId> changed, const Skeleton& before, const NodeIndex& at_before,
                   const Skeleton& now, const NodeIndex& at_now) {
    Touched out;
    for (const StableId id : changed) {
        if (const NodeId n = at_before[id]) {
            visit_around(before, n, [&](NodeId m) {
                out.boxes.push_back(influence_box(before, m));
                if (const NodeId still = at_now[before.stable_id(m)]) out.nodes.push_back(still);
            });
        }
        if (const NodeId n = at_now[id]) {
            visit_around(now, n, [&](NodeId m) {
                out.boxes.push_back(influence_box(now, m));
                out.nodes.push_back(m);
            });
        }
    }
    // Nodes in another order are added in another order, which changes the sums.
    NodeId last_before(0);
    for (const NodeId n : nodes(now)) {
        const NodeId o = at_before[now.stable_id(n)];
        if (!o) continue;
        if (o < last_before) {
            out.nodes.push_back(n);
            out.boxes.push_back(influence_box(now, n));
        } else {
            last_before = o;
        }
    }
    for (const NodeId n : out.nodes) out.ids.push_back(now.stable_id(n));
    return out;
}

std::optional<EditZone> edit_zone(const Skeleton& now, const Touched& touched, std::uint8_t trusted,
                                  const Context& ctx) {
    if (now.size() < kMinWhole) return {};
    std::vector<std::uint8_t> levels(now.size(), EditZone::kFar);
    for (const NodeId n : touched.nodes) levels[n.index()] = 0;
    mark_near(now, touched.boxes, 0, levels, ctx);
    spread(now, trusted, levels);
    const auto outer = static_cast<std::uint8_t>(trusted + 1);
    mark_near(now, boxes_up_to(now, levels, trusted), outer, levels, ctx);
    spread(now, static_cast<std::uint8_t>(trusted + kBeyond), levels);
    const std::vector<std::uint8_t> is_in = with_ways_and_children(now, levels);
    const auto count = std::ranges::count(is_in, 1);
    if (static_cast<float>(count) > kMaxOfTree * static_cast<float>(now.size())) return {};
    EditZone zone{part_of_tree(now, is_in), {}};
    for (const NodeId n : nodes(now)) {
        if (is_in[n.index()] == 0) continue;
        zone.level.push_back(levels[n.index()] <= trusted ? levels[n.index()] : EditZone::kFar);
    }
    return zone;
}

}  // namespace coppice::pipeline_internal
