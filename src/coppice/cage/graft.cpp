#include "coppice/cage/graft.h"

#include <algorithm>
#include <utility>

#include "coppice/base/compressed_rows.h"
#include "coppice/cage/graft_plan_internal.h"

namespace coppice {
namespace {

using namespace cage_internal;

/// A node of the skeleton with its cuts.
struct GraftNode {
    NodeId parent;
    NodeId segment;  ///< of the given skeleton, on which the node is
    float arc;       ///< [m] along its axis
    Vec3 position;
    float radius;
    NodeId attached;  ///< for the first node of a section that begins at another branch
    NodeId joined;    ///< for the last node of a section that ends in another branch: its node
    NodeId in_tree;   ///< the closest node of the tree of tubes towards the root, or itself
};

/// The skeleton with its cuts, before it is numbered as a tree of tubes.
struct CutSkeleton {
    std::vector<GraftNode> nodes;
    std::vector<NodeId> of_place;  ///< the new node of each place

    GraftNode& at(NodeId n) { return nodes[n.index()]; }
    const GraftNode& at(NodeId n) const { return nodes[n.index()]; }
};

struct Grafts {
    const AxisGeometry& axes;
    const Enclosure& enclosure;
    const GraftPlan& plan;
};

CutSkeleton cut_skeleton(const AxisGeometry& axes, const SegmentCuts& cuts) {
    const Skeleton& s = axes.skeleton;
    CutSkeleton out;
    out.of_place.resize(s.size() + cuts.cuts.size());
    out.nodes.reserve(out.of_place.size());
    std::vector<std::uint32_t> on_segment;
    for (const NodeId n : nodes(s)) {
        NodeId parent = s.is_root(n) ? NodeId::none() : out.of_place[s.parent(n).index()];
        on_segment.clear();
        cuts.for_each(n, [&](std::uint32_t c, float) { on_segment.push_back(c); });
        std::sort(on_segment.begin(), on_segment.end(), [&](std::uint32_t a, std::uint32_t b) {
            return cuts.cuts[a].point.t < cuts.cuts[b].point.t;
        });
        const auto add = [&](std::uint32_t place, float arc, Vec3 position, float radius) {
            out.of_place[place] = NodeId(static_cast<std::uint32_t>(out.nodes.size()));
            out.nodes.push_back({parent, n, arc, position, radius, {}, {}, {}});
            parent = out.of_place[place];
        };
        for (const std::uint32_t c : on_segment) {
            const AxisPoint p = cuts.cuts[c].point;
            const float start = axes.start(n);
            add(s.size() + c, start + p.t * (axes.axes.arc(n) - start), axes.position(p), axes.radius(p));
        }
        add(n.index(), axes.axes.arc(n), s.position(n), s.radius(n));
    }
    return out;
}

// Returns the middle of the segment that ends at a new node, along its axis.
float compute_middle(const Grafts& g, const CutSkeleton& cut, const GraftNode& n) {
    const GraftNode& parent = cut.at(n.parent);
    return 0.5f * ((parent.segment == n.segment ? parent.arc : g.axes.start(n.segment)) + n.arc);
}

bool is_visible(const Grafts& g, const CutSkeleton& cut, const GraftNode& n) {
    const std::uint32_t plan = g.plan.of_axis[g.axes.axes.find_axis(n.segment)];
    return plan == kNoIndex || g.plan.plans[plan].is_visible(compute_middle(g, cut, n));
}

// Returns the previous node of the tree of tubes. A node at which a section joins another branch has no
// successor.
NodeId in_tree_before(const CutSkeleton& cut, const GraftNode& n) {
    const GraftNode& parent = cut.at(n.parent);
    return parent.joined ? cut.at(parent.parent).in_tree : parent.in_tree;
}

void attach_sections(const Grafts& g, CutSkeleton& cut) {
    for (const std::uint32_t plan : g.plan.of_axis) {
        if (plan == kNoIndex) continue;
        for (const VisibleSection& p : g.plan.plans[plan].sections) {
            if (p.start != kNoIndex) cut.at(cut.of_place[p.start]).attached = cut.of_place[p.attach];
            if (p.join != kNoIndex) cut.at(cut.of_place[p.end]).joined = cut.of_place[p.join];
        }
    }
    for (std::uint32_t i = 0; i < cut.nodes.size(); ++i) {
        GraftNode& n = cut.nodes[i];
        const bool in_tree = !n.parent || n.attached || n.joined || is_visible(g, cut, n);
        n.in_tree = in_tree ? NodeId(i) : in_tree_before(cut, n);
    }
    // A section that ends at the branch where it begins is left unchanged.
    for (GraftNode& n : cut.nodes) {
        if (!n.joined || cut.at(n.joined).in_tree != in_tree_before(cut, n)) continue;
        n.joined = NodeId::none();
        n.in_tree = in_tree_before(cut, n);
    }
}

// Ranks decrease from a tube to its parent, so that the tubes form a tree.
NodeId parent_tube(const Grafts& g, const CutSkeleton& cut, const GraftNode& n) {
    const Axes& axes = g.axes.axes;
    const bool falls = n.attached && (!cut.at(n.attached).parent ||
                                      axes.rank(cut.at(n.attached).segment) < axes.rank(n.segment));
    return falls ? cut.at(n.attached).in_tree : in_tree_before(cut, n);
}

/// The tree of tubes before it is numbered: by new node; none for those that are not in it.
struct TubeTree {
    std::vector<NodeId> parent, roots;
    CompressedRows<NodeId> children;
};

TubeTree tube_tree(const Grafts& g, const CutSkeleton& cut) {
    const auto count = static_cast<std::uint32_t>(cut.nodes.size());
    TubeTree tree{std::vector<NodeId>(count), {}, {}};
    for (std::uint32_t i = 0; i < count; ++i) {
        const GraftNode& n = cut.nodes[i];
        if (n.in_tree != NodeId(i)) continue;
        if (n.parent) tree.parent[i] = parent_tube(g, cut, n);
    }
    tree.children = compress_rows<NodeId>(count, [&](const auto& put) {
        for (std::uint32_t i = 0; i < count; ++i) {
            if (tree.parent[i]) put(tree.parent[i].index(), NodeId(i));
        }
    });
    for (std::uint32_t i = 0; i < count; ++i) {
        const GraftNode& n = cut.nodes[i];
        // A root at which no section begins is left to the other tree.
        const bool is_left = tree.children[i].empty() && !g.axes.skeleton.is_tip(n.segment);
        if (!n.parent && !is_left) tree.roots.push_back(NodeId(i));
    }
    return tree;
}

Skeleton make_skeleton(const CutSkeleton& cut, Vec3d origin) {
    std::vector<NodeId> parent;
    std::vector<Vec3> position;
    std::vector<float> radius;
    for (const GraftNode& n : cut.nodes) {
        parent.push_back(n.parent);
        position.push_back(n.position);
        radius.push_back(n.radius);
    }
    return {std::move(parent), std::move(position), std::move(radius), origin};
}

// Returns the new node of the segment that contains a point of an axis.
NodeId node_holding(const SegmentCuts& cuts, const CutSkeleton& cut, std::uint32_t node_count, AxisPoint p) {
    NodeId best = cut.of_place[p.segment.index()];
    float nearest = 1;
    cuts.for_each(p.segment, [&](std::uint32_t c, float t) {
        if (t < p.t || t > nearest) return;
        nearest = t;
        best = cut.of_place[node_count + c];
    });
    return best;
}

/// Returns by new node the tube that contains its segment. `id` are the tubes' own nodes.
std::vector<NodeId> tubes_of_segments(const Grafts& g, const CutSkeleton& cut, std::span<const NodeId> id) {
    std::vector<NodeId> tube(cut.nodes.size());
    for (std::size_t i = 0; i < cut.nodes.size(); ++i) {
        const GraftNode& n = cut.nodes[i];
        if (n.in_tree.index() == i) {
            tube[i] = id[i];
            continue;
        }
        const std::uint32_t axis = g.axes.axes.find_axis(n.segment);
        const float middle = compute_middle(g, cut, n);
        if (const VisibleSection* ended = g.plan.plans[g.plan.of_axis[axis]].section_ended_before(middle)) {
            if (ended->join != kNoIndex) tube[i] = id[cut.at(cut.of_place[ended->end]).in_tree.index()];
            continue;
        }
        const AxisPoint parent = parent_at(g.axes, g.enclosure, g.plan, axis, middle);
        const NodeId holder =
            parent.segment ? node_holding(g.plan.cuts, cut, g.axes.skeleton.size(), parent) : n.parent;
        tube[i] = id[cut.at(holder).in_tree.index()];
    }
    return tube;
}

GraftResult number_tubes(const Grafts& g, const CutSkeleton& cut) {
    const TubeTree tree = tube_tree(g, cut);
    std::vector<NodeId> stack(tree.roots.rbegin(), tree.roots.rend());
    std::vector<NodeId> parent, source, id(cut.nodes.size());
    std::vector<Vec3> position;
    std::vector<float> radius;
    while (!stack.empty()) {
        const NodeId n = stack.back();
        stack.pop_back();
        const GraftNode& node = cut.at(n);
        const auto children = tree.children[n.index()];
        id[n.index()] = NodeId(static_cast<std::uint32_t>(parent.size()));
        parent.push_back(node.parent ? id[tree.parent[n.index()].index()] : NodeId::none());
        source.push_back(node.attached && !children.empty() ? children[0] : n);
        position.push_back(node.joined ? cut.at(cut.at(node.joined).in_tree).position : node.position);
        radius.push_back(node.radius);
        stack.insert(stack.end(), children.rbegin(), children.rend());
    }
    const Vec3d origin = g.axes.skeleton.origin();
    Skeleton tubes(std::move(parent), std::move(position), std::move(radius), origin);
    std::vector<NodeId> segment;
    for (const GraftNode& n : cut.nodes) segment.push_back(n.segment);
    std::vector<NodeJoin> joins;
    for (std::size_t i = 0; i < cut.nodes.size(); ++i) {
        if (!cut.nodes[i].joined) continue;
        const NodeId at = id[cut.at(cut.nodes[i].joined).in_tree.index()];
        if (id[i] && at) joins.push_back({id[i], at});
    }
    std::ranges::sort(joins, {}, &NodeJoin::end);
    GraftReport report = g.plan.report;
    report.joined = g.axes.skeleton.tree_count() - tubes.tree_count();
    report.merged = static_cast<std::uint32_t>(joins.size());
    report.truncated -= report.merged;
    return {make_skeleton(cut, origin),
            std::move(tubes),
            std::move(segment),
            std::move(source),
            tubes_of_segments(g, cut, id),
            std::move(joins),
            report};
}

}  // namespace

GraftResult graft_branches(const Skeleton& skeleton, float depth, SectionEnd end, const Context& ctx) {
    if (!(depth > 0) || skeleton.size() <= 2) {
        std::vector<NodeId> same;
        for (const NodeId n : nodes(skeleton)) same.push_back(n);
        return {skeleton, skeleton, same, same, same, {}, {}};
    }
    const Axes order(skeleton);
    const AxisGeometry axes{skeleton, order};
    const Enclosure enclosure(depth);
    const GraftPlan plan = plan_grafts(axes, enclosure, end, ctx);
    const Grafts grafts{axes, enclosure, plan};
    CutSkeleton cut = cut_skeleton(axes, plan.cuts);
    attach_sections(grafts, cut);
    return number_tubes(grafts, cut);
}

}  // namespace coppice
