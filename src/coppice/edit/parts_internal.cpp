#include "coppice/edit/parts_internal.h"

#include "coppice/base/kernel/round_cone.h"
#include "coppice/edit/selection.h"
#include "coppice/skeleton/segment_cone.h"

namespace coppice::edit_internal {

void check_set(const EditableTree& tree, const NodeSet& set) {
    if (set.empty()) throw InvalidInput("no node is selected; use select to list the nodes of a selection");
    for (const StableId n : set) check_node(tree, n);
}

std::vector<StableId> find_tops(const EditableTree& tree, const NodeSet& set) {
    std::vector<StableId> tops;
    // Paths are not cached: a set is usually a subtree, and its nodes find their parents in it at once.
    for (const StableId n : set) {
        StableId above = tree.parent(n);
        while (above && !holds(set, above)) above = tree.parent(above);
        if (!above) tops.push_back(n);
    }
    return tops;
}

Vec3d compute_direction(const EditableTree& tree, StableId n) {
    if (!tree.is_root(n)) return normalized(get_position(tree, n) - get_position(tree, tree.parent(n)));
    if (tree.is_tip(n)) return {0, 0, 1};
    return normalized(get_position(tree, tree.leader(n)) - get_position(tree, n));
}

bool hangs_on(const EditableTree& tree, StableId n, StableId top) {
    for (; n; n = tree.parent(n)) {
        if (n == top) return true;
    }
    return false;
}

std::vector<StableId> axis_from(const EditableTree& tree, StableId n) {
    std::vector<StableId> axis{n};
    while (!tree.is_tip(axis.back())) axis.push_back(tree.leader(axis.back()));
    return axis;
}

StableId split_segment(TreeEdit& edit, const EditableTree& tree, StableId n, double t) {
    const StableId parent = tree.parent(n);
    const Segment s = tree.segment(n);
    const bool leads = tree.leader(parent) == n;
    float radius = static_cast<float>(s.radius_a + (double{s.radius_b} - s.radius_a) * t);
    // The new node is the last of its siblings, so that it has to be the thickest to be the leader in place
    // of n.
    for (StableId c = tree.first_child(parent); leads && c; c = tree.next_sibling(c)) {
        if (c != n && tree.radius(c) >= radius) radius = std::nextafter(tree.radius(c), 1e30f);
    }
    const StableId middle = edit.add(parent, Vec3(lerp(Vec3d(s.a), Vec3d(s.b), t)), radius);
    edit.set_parent(n, middle);
    return middle;
}

void limit_radii(TreeEdit& edit, const EditableTree& tree, StableId top, float limit) {
    tree.visit_subtree(top, [&](StableId n) {
        if (tree.radius(n) > limit) edit.set_radius(n, limit);
    });
}

ClosestPoint closest_point_on_segment(const EditableTree& tree, StableId n, Vec3d p) {
    const auto cone = tree.is_root(n) ? round_cone(get_position(tree, n), get_position(tree, n),
                                                   double{tree.radius(n)}, double{tree.radius(n)})
                                      : round_cone<double>(tree.segment(n));
    const auto closest = cone.closest_point(p);
    return {n, tree.is_root(n) ? 1.0 : closest.t, p - closest.offset, closest.distance(), closest.radius};
}

StableId node_at(TreeEdit& edit, const EditableTree& tree, const ClosestPoint& closest) {
    constexpr double kNear = 0.2;  // [radius] much shorter segments have no visible effect
    if (tree.is_root(closest.node)) return closest.node;
    const StableId parent = tree.parent(closest.node);
    const double room = kNear * closest.radius;
    if (closest.t >= 1 || distance(closest.place, get_position(tree, closest.node)) <= room)
        return closest.node;
    if (closest.t <= 0 || distance(closest.place, get_position(tree, parent)) <= room) return parent;
    return split_segment(edit, tree, closest.node, closest.t);
}

}  // namespace coppice::edit_internal
