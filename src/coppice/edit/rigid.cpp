#include "coppice/edit/rigid.h"

#include <fmt/format.h>

#include <unordered_map>

#include "coppice/edit/motion_internal.h"
#include "coppice/edit/parts_internal.h"

namespace coppice {

using namespace edit_internal;

namespace {

/// Moves branches, each by motion(top, joint).
template <class MotionOf>
void move_branches(TreeEdit& edit, const EditableTree& tree, const NodeSet& nodes, const MotionOf& motion) {
    check_set(tree, nodes);
    for (const StableId top : find_tops(tree, nodes)) {
        const Vec3 joint = tree.position(find_joint(tree, top));
        edit.move_subtree(top, motion(top, Motion{.from = joint, .to = Vec3d(joint), .turn = {}}));
    }
}

Vec3d checked_direction(Vec3d v, const char* subject) {
    if (!is_finite(v) || !(length_squared(v) > 0))
        throw InvalidInput(
            fmt::format("the {} has no direction; enter three numbers that are not all 0", subject));
    return normalized(v);
}

Vec3d axis_of_turn(const EditableTree& tree, StableId top, const TurnOptions& options) {
    const Vec3d own = compute_direction(tree, top);
    const Vec3d parent_direction =
        tree.is_root(top) ? Vec3d{0, 0, 1} : compute_direction(tree, tree.parent(top));
    switch (options.about) {
        case TurnAxis::own:
            return own;
        case TurnAxis::host:
            return parent_direction;
        case TurnAxis::side:
            return normalized(cross(own, parent_direction), perpendicular(own));
        case TurnAxis::given:
            break;
    }
    return checked_direction(options.axis, "axis");
}

void copy_mirrored(TreeEdit& edit, const EditableTree& tree, StableId top, Vec3d normal) {
    const Vec3d joint = get_position(tree, find_joint(tree, top));
    std::unordered_map<std::uint32_t, StableId> copy_of;
    for (const StableId n : tree.subtree(top)) {
        const Vec3d p = get_position(tree, n) - joint;
        const StableId parent = n == top ? tree.parent(n) : copy_of.at(tree.parent(n).index());
        copy_of[n.index()] =
            edit.add(parent, Vec3(joint + p - normal * (2 * dot(p, normal))), tree.radius(n));
    }
}

}  // namespace

EditChange translate(EditableTree& tree, const NodeSet& nodes, Vec3d by) {
    TreeEdit edit(tree);
    move_branches(edit, tree, nodes, [&](StableId, Motion m) {
        m.to += by;
        return m;
    });
    return edit.commit();
}

EditChange rotate(EditableTree& tree, const NodeSet& nodes, const TurnOptions& options) {
    TreeEdit edit(tree);
    move_branches(edit, tree, nodes, [&](StableId top, Motion m) {
        m.turn = rotation_about(axis_of_turn(tree, top, options), options.angle);
        return m;
    });
    return edit.commit();
}

EditChange scale(EditableTree& tree, const NodeSet& nodes, double factor, bool radii) {
    if (!(factor > 0) || !std::isfinite(factor))
        throw InvalidInput(fmt::format("the factor {} is not above 0; enter 0.5 for half the size", factor));
    TreeEdit edit(tree);
    move_branches(edit, tree, nodes, [&](StableId, Motion m) {
        m.factor = factor;
        return m;
    });
    if (radii) {
        for (const StableId top : find_tops(tree, nodes)) {
            tree.visit_subtree(
                top, [&](StableId n) { edit.set_radius(n, static_cast<float>(tree.radius(n) * factor)); });
        }
    }
    return edit.commit();
}

EditChange mirror(EditableTree& tree, const NodeSet& nodes, Vec3d normal, bool copy) {
    const Vec3d across = checked_direction(normal, "normal");
    TreeEdit edit(tree);
    if (copy) {
        check_set(tree, nodes);
        for (const StableId top : find_tops(tree, nodes)) {
            if (tree.is_root(top)) {
                throw InvalidInput(
                    fmt::format("node {} is a root, so that its mirrored copy would begin in it; mirror its "
                                "branches, as in children({})",
                                top.index(), top.index()));
            }
            copy_mirrored(edit, tree, top, across);
        }
    } else {
        // Half a turn about the normal, and a negative factor.
        move_branches(edit, tree, nodes, [&](StableId, Motion m) {
            m.turn = {0, across};
            m.factor = -1;
            return m;
        });
    }
    return edit.commit();
}

}  // namespace coppice
