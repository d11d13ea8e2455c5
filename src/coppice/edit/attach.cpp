#include <algorithm>
#include <cmath>
#include <unordered_map>

#include "coppice/base/kernel/round_cone.h"
#include "coppice/edit/join.h"
#include "coppice/edit/parts_internal.h"
#include "coppice/skeleton/segment_cone.h"
#include "coppice/spatial/box_tree.h"

namespace coppice {

using namespace edit_internal;

namespace {

/// Spatial index of the branches of a tree at construction. Segments that are split later are found through
/// the list of their new nodes.
class BranchIndex {
  public:
    BranchIndex(const EditableTree& tree, const Context& ctx)
        : tree_(tree), node_(tree.nodes()), boxes_(compute_boxes(tree, node_), ctx) {}

    /// Returns the closest axis point of the branch in which p is deepest, among trees other than that of
    /// `root`; none if p is outside all branches.
    ClosestPoint around(StableId root, Vec3d p) const {
        ClosestPoint best;
        visit_near({Vec3(p), Vec3(p)}, [&](StableId n) {
            if (!tree_.contains(n) || (tree_.is_root(n) && !tree_.is_tip(n))) return;
            const ClosestPoint closest = on_pieces(n, p);
            if (closest.distance >= closest.radius || tree_.find_root(n) == root) return;
            const bool deeper = !best.node || closest.distance / closest.radius < best.distance / best.radius;
            const bool tied = best.node && closest.distance / closest.radius == best.distance / best.radius;
            if (deeper || (tied && closest.node < best.node)) best = closest;
        });
        return best;
    }

    /// Calls visit(n) for the segments that end at n and may intersect the box.
    template <class Visit>
    void visit_near(const Box3& box, const Visit& visit) const {
        boxes_.visit_overlapping(box, [&](std::uint32_t item) { visit(node_[item]); });
    }

    /// Returns the closest point to p on the original segment that ended at n.
    ClosestPoint on_pieces(StableId n, Vec3d p) const {
        ClosestPoint best = closest_point_on_segment(tree_, n, p);
        const auto found = pieces_.find(n.index());
        if (found == pieces_.end()) return best;
        for (const StableId piece : found->second) {
            const ClosestPoint closest = closest_point_on_segment(tree_, piece, p);
            if (closest.distance < best.distance) best = closest;
        }
        return best;
    }

    /// As node_at, for a point that was found by this index.
    StableId split(TreeEdit& edit, const ClosestPoint& closest) {
        const std::uint32_t slots = tree_.slots();
        const StableId at = node_at(edit, tree_, closest);
        if (at.index() < slots) return at;
        const StableId n = whole(closest.node);
        whole_[at.index()] = n;
        pieces_[n.index()].push_back(at);
        return at;
    }

    /// Returns the end of the original segment for a node that was inserted into it; otherwise the node
    /// itself.
    StableId whole(StableId n) const {
        const auto found = whole_.find(n.index());
        return found == whole_.end() ? n : found->second;
    }

  private:
    static std::vector<Box3> compute_boxes(const EditableTree& tree, const NodeSet& nodes) {
        std::vector<Box3> boxes;
        for (const StableId n : nodes) {
            const Vec3 from = tree.position(find_joint(tree, n));
            boxes.push_back(capsule_box(from, tree.position(n),
                                        std::max(tree.radius(n), tree.radius(find_joint(tree, n)))));
        }
        return boxes;
    }

    const EditableTree& tree_;
    NodeSet node_;
    BoxTree boxes_;
    std::unordered_map<std::uint32_t, std::vector<StableId>> pieces_;  ///< nodes inserted into a segment
    std::unordered_map<std::uint32_t, StableId> whole_;                ///< inverse map
};

void attach_root(TreeEdit& edit, const EditableTree& tree, BranchIndex& branch_index, StableId root,
                 const ClosestPoint& closest) {
    const StableId parent_node = branch_index.split(edit, closest);
    limit_radii(edit, tree, root, static_cast<float>(closest.radius));
    if (tree.position(root) != tree.position(parent_node)) return edit.set_parent(root, parent_node);
    while (!tree.is_tip(root)) edit.set_parent(tree.first_child(root), parent_node);
    edit.remove(root);
}

/// Interval of an axis inside a segment of another axis.
struct Passage {
    double enters = 0, leaves = 0;  ///< [m] along the axis from its joint
    double deepest = 0;             ///< [m] along the axis, closest to the other axis
    double depth = 0;               ///< distance there divided by the radius of the branch; < 1
    StableId node;                  ///< end of the segment of the axis
    StableId parent_node;           ///< end of the other segment
    bool at_joint = false;          ///< whether the other axis leaves this one within the interval
};

/// A point at which a branch is cut; its outer portion is attached to the other segment.
struct Cut {
    StableId node, parent_node;
    Vec3d place;       ///< [m] on the axis of the branch
    double along = 0;  ///< [m] from its joint
};

/// Finds the intersections of axes with other branches.
class CrossingSearch {
  public:
    CrossingSearch(const EditableTree& tree, const BranchIndex& branch_index)
        : tree_(tree), branch_index_(branch_index), at_(tree.slots()) {
        std::uint32_t number = 0;
        for (StableId root = tree.first_root(); root; root = tree.next_sibling(root)) {
            tree.visit_subtree(root, [&](StableId n) {
                order_.push_back(n);
                at_[n].first = at_[n].last = number++;
                if (tree.is_root(n)) {
                    at_[n].axis = n;
                    return;
                }
                const StableId p = tree.parent(n);
                const bool leads = tree.leader(p) == n;
                at_[n].axis = leads ? at_[p].axis : n;
                at_[n].along =
                    (leads ? at_[p].along : 0) + distance(get_position(tree, p), get_position(tree, n));
            });
        }
        for (auto n = order_.rbegin(); n != order_.rend(); ++n) {
            if (tree.is_root(*n)) continue;
            std::uint32_t& last = at_[tree.parent(*n)].last;
            last = std::max(last, at_[*n].last);
        }
    }

    /// Returns the cuts of all axes, for each axis from the tip to the joint.
    std::vector<Cut> cuts(const Column<StableId, std::uint8_t>& chosen, const Context& ctx) const {
        std::vector<Cut> out;
        for (const StableId n : order_) {
            const bool begins = at_[n].axis == n;
            if (!begins) continue;
            ctx.throw_if_cancelled();
            std::vector<Passage> passages;
            double length = 0;
            for (StableId on = tree_.is_root(n) ? tree_.leader(n) : n; on; on = tree_.leader(on)) {
                find_passages(on, passages);
                length = at_[on].along;
            }
            add_cuts(passages, length, chosen, out);
        }
        return out;
    }

  private:
    struct At {
        StableId axis;     ///< its first node after its joint, or a root
        double along = 0;  ///< [m] from the joint of the axis
        std::uint32_t first = 0,
                      last = 0;  ///< range of the numbers of its descendants, beginning with itself
    };

    bool hangs_on(StableId n, StableId top) const {
        return at_[top].first <= at_[n].first && at_[n].first <= at_[top].last;
    }

    /// Returns whether, of two overlapping segments, the one that ends at n is cut.
    bool gives_way(StableId n, double radius, StableId parent_node, double parent_radius) const {
        if (hangs_on(parent_node, n)) return false;
        if (hangs_on(n, parent_node)) return true;
        return radius < parent_radius || (radius == parent_radius && parent_node < n);
    }

    void find_passages(StableId n, std::vector<Passage>& out) const {
        const Vec3d a = get_position(tree_, tree_.parent(n)), b = get_position(tree_, n);
        const double length = distance(a, b), end = at_[n].along;
        Box3 box{Vec3(a), Vec3(a)};
        box.extend(Vec3(b));
        branch_index_.visit_near(box, [&](StableId parent_node) {
            if (tree_.is_root(parent_node) || at_[parent_node].axis == at_[n].axis) return;
            const auto cone = round_cone<double>(tree_.segment(parent_node));
            const auto outside = [&](double t) {
                return cone.closest_point(lerp(a, b, t)).signed_distance();
            };
            const double deepest = closest_parameters(a, b, cone.a, cone.b()).on_a;
            if (outside(deepest) >= 0) return;
            const auto closest = cone.closest_point(lerp(a, b, deepest));
            if (!gives_way(n, std::lerp(radius_at_start(n), double{tree_.radius(n)}, deepest), parent_node,
                           closest.radius))
                return;
            const auto along = [&](double t) { return end - (1 - t) * length; };
            const Passage p{.enters = along(boundary(outside, deepest, 0)),
                            .leaves = along(boundary(outside, deepest, 1)),
                            .deepest = along(deepest),
                            .depth = closest.distance() / closest.radius,
                            .node = n,
                            .parent_node = parent_node};
            out.push_back(p);
            out.back().at_joint = holds_joint(p);
        });
    }

    double radius_at_start(StableId n) const { return double{tree_.segment(n).radius_a}; }

    /// Returns the parameter between `inside` and `to` at which the axis leaves the branch.
    template <class Outside>
    static double boundary(const Outside& outside, double inside, double to) {
        if (outside(to) < 0) return to;
        double out = to;
        for (int i = 0; i < 40; ++i) {
            const double middle = 0.5 * (inside + out);
            (outside(middle) < 0 ? inside : out) = middle;
        }
        return inside;
    }

    /// Returns whether the axis of the other segment leaves this axis within the passage.
    bool holds_joint(const Passage& p) const {
        const StableId other = at_[p.parent_node].axis;
        if (tree_.is_root(other)) return false;
        const StableId joint = tree_.parent(other);
        if (at_[joint].axis != at_[p.node].axis) return false;
        const double where = at_[joint].along, touching = kTouching * at_[p.node].along;
        return p.enters - touching <= where && where <= p.leaves + touching;
    }

    /// Merges passages that touch and creates one cut at the deepest of each group.
    void add_cuts(std::vector<Passage>& passages, double length, const Column<StableId, std::uint8_t>& chosen,
                  std::vector<Cut>& out) const {
        std::ranges::sort(passages, {}, [](const Passage& p) { return std::pair(p.enters, p.parent_node); });
        const double touching = kTouching * length;
        const std::size_t before = out.size();
        for (std::size_t i = 0; i < passages.size();) {
            const Passage* deepest = &passages[i];
            double leaves = 0;
            // the beginning of an axis is inside its parent branch
            bool joined = passages[i].enters <= touching;
            for (; i < passages.size() && (leaves == 0 || passages[i].enters <= leaves + touching); ++i) {
                leaves = std::max(leaves, passages[i].leaves);
                joined = joined || passages[i].at_joint;
                if (passages[i].depth < deepest->depth) deepest = &passages[i];
            }
            if (joined || leaves >= length - touching || chosen[deepest->node] == 0) continue;
            const Vec3d from = get_position(tree_, tree_.parent(deepest->node)),
                        to = get_position(tree_, deepest->node);
            const double t = 1 - (at_[deepest->node].along - deepest->deepest) / distance(from, to);
            out.push_back({deepest->node, deepest->parent_node, lerp(from, to, t), deepest->deepest});
        }
        std::reverse(out.begin() + static_cast<std::ptrdiff_t>(before), out.end());
    }

    static constexpr double kTouching = 1e-6;  // [length of the axis]

    const EditableTree& tree_;
    const BranchIndex& branch_index_;
    Column<StableId, At> at_;
    std::vector<StableId> order_;
};

/// Marks the nodes and their descendants.
Column<StableId, std::uint8_t> find_subtrees(const EditableTree& tree, const NodeSet& nodes) {
    Column<StableId, std::uint8_t> chosen(tree.slots());
    for (const StableId top : nodes) {
        if (chosen[top] == 0) tree.visit_subtree(top, [&](StableId n) { chosen[n] = 1; });
    }
    return chosen;
}

bool may_hang(const EditableTree& tree, StableId n, StableId parent_node) {
    const auto is_on = [&](StableId other) { return tree.position(n) == tree.position(other); };
    if (is_on(parent_node) || hangs_on(tree, parent_node, n)) return false;
    for (StableId c = tree.first_child(parent_node); c; c = tree.next_sibling(c)) {
        if (is_on(c)) return false;
    }
    return true;
}

/// Cuts a branch and attaches its outer portion to the other segment, unless that became a descendant of it
/// by a previous cut.
void make_cut(TreeEdit& edit, const EditableTree& tree, BranchIndex& branch_index, const Cut& cut) {
    // If a segment was cut before, finds its section that contains the point.
    const ClosestPoint own = branch_index.on_pieces(cut.node, cut.place),
                       closest = branch_index.on_pieces(cut.parent_node, cut.place);
    if (closest.distance >= closest.radius || hangs_on(tree, closest.node, own.node)) return;
    const StableId end = branch_index.split(edit, own), parent_node = branch_index.split(edit, closest);
    std::vector<StableId> outer{own.node};
    if (end == own.node) {
        outer.clear();
        for (StableId c = tree.first_child(end); c; c = tree.next_sibling(c)) outer.push_back(c);
    }
    for (const StableId n : outer) {
        if (!may_hang(tree, n, parent_node)) continue;
        limit_radii(edit, tree, n, static_cast<float>(closest.radius));
        edit.set_parent(n, parent_node);
    }
}

/// Joins the crossings of the chosen nodes, including nodes inserted into their segments.
void join_crossings(TreeEdit& edit, const EditableTree& tree, const BranchIndex& before,
                    Column<StableId, std::uint8_t> chosen, const Context& ctx) {
    const std::uint32_t known = chosen.size();
    chosen.resize(tree.slots());
    for (std::uint32_t i = known; i < tree.slots(); ++i)
        chosen[StableId(i)] = chosen[before.whole(StableId(i))];
    BranchIndex branch_index(tree, ctx);
    for (const Cut& cut : CrossingSearch(tree, branch_index).cuts(chosen, ctx)) {
        ctx.throw_if_cancelled();
        make_cut(edit, tree, branch_index, cut);
    }
}

}  // namespace

EditChange attach(EditableTree& tree, const NodeSet& nodes, Crossings crossings, const Context& ctx) {
    check_set(tree, nodes);
    NodeSet roots;
    std::ranges::copy_if(nodes, std::back_inserter(roots), [&](StableId n) { return tree.is_root(n); });
    if (roots.empty() && crossings == Crossings::keep)
        throw InvalidInput("no root is selected; attach joins trees by their roots, as with: attach roots");
    TreeEdit edit(tree);
    BranchIndex branch_index(tree, ctx);
    const Column<StableId, std::uint8_t> chosen = find_subtrees(tree, nodes);
    for (const StableId root : roots) {
        ctx.throw_if_cancelled();
        const ClosestPoint closest = branch_index.around(root, get_position(tree, root));
        if (closest.node) attach_root(edit, tree, branch_index, root, closest);
    }
    if (crossings == Crossings::join) join_crossings(edit, tree, branch_index, chosen, ctx);
    return edit.commit();
}

}  // namespace coppice
