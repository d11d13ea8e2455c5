#include "coppice/edit/join.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>

#include "coppice/edit/motion_internal.h"
#include "coppice/edit/parts_internal.h"
#include "coppice/edit/selection.h"

namespace coppice {

using namespace edit_internal;

namespace {

constexpr Vec3d kUp{0, 0, 1};

struct DrawnRadii {
    double first, last;
};

DrawnRadii compute_radii(const DrawOptions& options, double otherwise, double limit) {
    for (const double r : {options.radius, options.tip_radius}) {
        if (!(r >= 0) || !std::isfinite(r))
            throw InvalidInput(
                fmt::format("a branch cannot have the radius {}; enter a radius above 0, or 0 for the radius "
                            "of the parent branch",
                            r));
    }
    const double first = std::min(options.radius > 0 ? options.radius : otherwise, limit);
    const double last = options.tip_radius > 0 ? options.tip_radius : 0.25 * first;
    return {first, std::min(last, limit)};
}

ClosestPoint find_start_point(const EditableTree& tree, Vec3d place, double snap) {
    const ClosestPoint closest = find_closest_point(tree, place, [](StableId) { return true; });
    if (closest.distance > snap * closest.radius) {
        throw InvalidInput(
            fmt::format("the first point is {:.4g} m from the nearest axis, at node {}, with the radius "
                        "{:.4g} m; begin nearer, raise snap, or draw it alone",
                        closest.distance, closest.node.index(), closest.radius));
    }
    return closest;
}

/// Returns the branches that a graft moves: the given one, or all children of a root.
std::vector<StableId> branches_to_graft(const EditableTree& tree, StableId branch) {
    if (!tree.is_root(branch)) return {branch};
    std::vector<StableId> all;
    for (StableId c = tree.first_child(branch); c; c = tree.next_sibling(c)) all.push_back(c);
    if (all.empty()) {
        throw InvalidInput(fmt::format(
            "node {} is a tree of a single node, without branches to graft; append to the host instead",
            branch.index()));
    }
    return all;
}

/// Returns the point at which a branch is grafted.
ClosestPoint find_attachment(const EditableTree& tree, StableId parent_node, double along) {
    check_node(tree, parent_node);
    if (!(along >= 0 && along <= 1)) {
        throw InvalidInput(
            fmt::format("along is {}; it must be from 0, the parent of the host, to 1, the host", along));
    }
    ClosestPoint closest{.node = parent_node,
                         .t = along,
                         .place = get_position(tree, parent_node),
                         .distance = 0,
                         .radius = double{tree.radius(parent_node)}};
    if (!tree.is_root(parent_node) && along < 1) {
        const Segment s = tree.segment(parent_node);
        closest.place = lerp(Vec3d(s.a), Vec3d(s.b), along);
        closest.radius = s.radius_a + (double{s.radius_b} - s.radius_a) * along;
    }
    return closest;
}

/// Returns the rotation from the previous direction of the parent branch to that of the parent node.
Rotation turn_to(const EditableTree& tree, Vec3d old_way, StableId parent_node, const GraftOptions& options) {
    return options.align ? rotation_between(old_way, compute_direction(tree, parent_node)) : Rotation{};
}

}  // namespace

EditChange draw(EditableTree& tree, std::span<const Vec3d> points, const DrawOptions& options) {
    if (points.size() < 2)
        throw InvalidInput(
            fmt::format("a branch is drawn through two points or more, not {}", points.size()));
    std::vector<Vec3d> place;
    std::vector<double> along;
    for (const Vec3d p : points) {
        if (!is_finite(p))
            throw InvalidInput("a point to draw through is not finite; enter three finite numbers");
        place.push_back(p - tree.origin());
        along.push_back(along.empty() ? 0 : along.back() + distance(place.back(), place[place.size() - 2]));
    }
    TreeEdit edit(tree);
    StableId last;
    DrawnRadii radii{};
    if (options.alone) {
        radii = compute_radii(options, along.back() / 50, 1e15);
        last = edit.add(StableId::none(), Vec3(place[0]), static_cast<float>(radii.first));
    } else {
        const ClosestPoint closest = find_start_point(tree, place[0], options.snap);
        radii = compute_radii(options, 0.5 * closest.radius, closest.radius);
        last = node_at(edit, tree, closest);
    }
    for (std::size_t i = 1; i < place.size(); ++i) {
        const double t = along.back() > 0 ? along[i] / along.back() : 1;
        last =
            edit.add(last, Vec3(place[i]), static_cast<float>(radii.first + (radii.last - radii.first) * t));
    }
    return edit.commit();
}

EditChange append(EditableTree& tree, StableId parent_node, Vec3d by, double radius) {
    check_node(tree, parent_node);
    TreeEdit edit(tree);
    if (!(radius >= 0))
        throw InvalidInput(
            fmt::format("the radius {} is not above 0; enter 0 for the radius of the host", radius));
    edit.add(parent_node, Vec3(get_position(tree, parent_node) + by),
             radius > 0 ? static_cast<float>(radius) : tree.radius(parent_node));
    return edit.commit();
}

EditChange graft(EditableTree& tree, StableId branch, StableId parent_node, const GraftOptions& options) {
    check_node(tree, branch);
    const ClosestPoint closest = find_attachment(tree, parent_node, options.along);
    const std::vector<StableId> tops = branches_to_graft(tree, branch);
    if (hangs_on(tree, parent_node, branch)) {
        throw InvalidInput(
            fmt::format("node {1} hangs on node {0}, so that {0} would be grafted into itself; choose a host "
                        "outside the subtree of {0}",
                        branch.index(), parent_node.index()));
    }
    TreeEdit edit(tree);
    const StableId joint = find_joint(tree, branch);
    const Vec3d old_way = tree.is_root(branch) ? kUp : compute_direction(tree, joint);
    const Rotation turn = turn_to(tree, old_way, parent_node, options);
    const StableId at = node_at(edit, tree, closest);
    const Motion motion{.from = tree.position(joint), .to = get_position(tree, at), .turn = turn};
    for (const StableId top : tops) {
        edit.move_subtree(top, motion);
        if (options.limit_radius) limit_radii(edit, tree, top, static_cast<float>(closest.radius));
        edit.set_parent(top, at);
    }
    if (tree.is_root(branch)) edit.remove(branch);
    return edit.commit();
}

EditChange graft(EditableTree& tree, const Skeleton& branch, StableId parent_node,
                 const GraftOptions& options) {
    if (branch.tree_count() != 1 || branch.size() < 2)
        throw InvalidInput("the grafted skeleton must be a single tree with a root and at least one segment");
    const ClosestPoint closest = find_attachment(tree, parent_node, options.along);
    TreeEdit edit(tree);
    const Rotation turn = turn_to(tree, kUp, parent_node, options);
    const StableId at = node_at(edit, tree, closest);
    const Vec3d from(branch.position(NodeId(0))), to = get_position(tree, at);
    const float most =
        options.limit_radius ? static_cast<float>(closest.radius) : std::numeric_limits<float>::infinity();
    std::vector<StableId> ids{at};
    for (const NodeId n : nodes(branch)) {
        if (branch.is_root(n)) continue;
        const Vec3d place = to + turn(Vec3d(branch.position(n)) - from);
        ids.push_back(edit.add(ids[branch.parent(n).index()], Vec3(place), std::min(most, branch.radius(n))));
    }
    return edit.commit();
}

}  // namespace coppice
