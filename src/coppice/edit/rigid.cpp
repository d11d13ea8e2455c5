#include "coppice/edit/rigid.h"

#include <fmt/format.h>

#include <type_traits>
#include <unordered_map>

#include "coppice/base/rotation.h"
#include "coppice/edit/parts_internal.h"

namespace coppice {

using namespace edit_internal;

namespace {

/// Puts every node of the branches where place(top, p) says, p being relative to the joint.
template <class Place>
void place_branches(TreeEdit& edit, const EditableTree& tree, const NodeSet& nodes, const Place& place) {
    check_set(tree, nodes);
    for (const StableId top : tops_of(tree, nodes)) {
        const Vec3d joint = place_of(tree, joint_of(tree, top));
        const auto moved = place(top);
        tree.visit_subtree(top, [&](StableId n) {
            edit.move(n, Vec3(joint + moved(place_of(tree, n) - joint)));
            if constexpr (std::is_same_v<std::remove_cvref_t<decltype(moved)>, Rotation>) edit.turn(n, moved);
        });
    }
}

Vec3d checked_direction(Vec3d v, const char* what) {
    if (!is_finite(v) || !(length_squared(v) > 0))
        throw InvalidInput(
            fmt::format("the {} has no direction; give three numbers that are not all 0", what));
    return normalized(v);
}

Vec3d axis_of_turn(const EditableTree& tree, StableId top, const TurnOptions& options) {
    const Vec3d own = direction_of(tree, top);
    const Vec3d host = tree.is_root(top) ? Vec3d{0, 0, 1} : direction_of(tree, tree.parent(top));
    switch (options.about) {
        case TurnAxis::own:
            return own;
        case TurnAxis::host:
            return host;
        case TurnAxis::side:
            return normalized(cross(own, host), perpendicular(own));
        case TurnAxis::given:
            break;
    }
    return checked_direction(options.axis, "axis");
}

void copy_mirrored(TreeEdit& edit, const EditableTree& tree, StableId top, Vec3d normal) {
    const Vec3d joint = place_of(tree, joint_of(tree, top));
    std::unordered_map<std::uint32_t, StableId> copy_of;
    for (const StableId n : tree.subtree(top)) {
        const Vec3d p = place_of(tree, n) - joint;
        const StableId parent = n == top ? tree.parent(n) : copy_of.at(tree.parent(n).index());
        copy_of[n.index()] =
            edit.add(parent, Vec3(joint + p - normal * (2 * dot(p, normal))), tree.radius(n));
    }
}

}  // namespace

EditChange translate(EditableTree& tree, const NodeSet& nodes, Vec3d by) {
    TreeEdit edit(tree);
    place_branches(edit, tree, nodes, [&](StableId) { return [&](Vec3d p) { return p + by; }; });
    return edit.commit();
}

EditChange rotate(EditableTree& tree, const NodeSet& nodes, const TurnOptions& options) {
    TreeEdit edit(tree);
    place_branches(edit, tree, nodes, [&](StableId top) {
        const Vec3d axis = axis_of_turn(tree, top, options);
        return rotation_about(axis, options.angle);
    });
    return edit.commit();
}

EditChange scale(EditableTree& tree, const NodeSet& nodes, double factor, bool radii) {
    if (!(factor > 0) || !std::isfinite(factor))
        throw InvalidInput(fmt::format("the factor {} is not above 0; give 0.5 for half the size", factor));
    TreeEdit edit(tree);
    place_branches(edit, tree, nodes, [&](StableId) { return [&](Vec3d p) { return p * factor; }; });
    if (radii) {
        for (const StableId top : tops_of(tree, nodes)) {
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
        for (const StableId top : tops_of(tree, nodes)) {
            if (tree.is_root(top)) {
                throw InvalidInput(
                    fmt::format("node {} is a root, so that its mirrored copy would begin in it; "
                                "mirror what hangs on it, as children({})",
                                top.index(), top.index()));
            }
            copy_mirrored(edit, tree, top, across);
        }
    } else {
        place_branches(edit, tree, nodes,
                       [&](StableId) { return [&](Vec3d p) { return p - across * (2 * dot(p, across)); }; });
    }
    return edit.commit();
}

}  // namespace coppice
