#include "coppice/edit/anchor.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>

#include "coppice/base/box.h"
#include "coppice/edit/parts_internal.h"
#include "coppice/edit/selection.h"

namespace coppice {

using namespace edit_internal;

AnchorFrame anchor_frame(const EditableTree& tree) {
    Box3 box;
    for (const StableId n : tree.nodes()) box.extend(tree.position(n));
    const Vec3 size = box.size();
    const double extent = double{std::max({size.x, size.y, size.z})};
    return {tree.origin() + place_of(tree, tree.first_root()), extent > 0 ? extent : 1};
}

Anchor anchor_of(const EditableTree& tree, const AnchorFrame& frame, StableId node) {
    check_node(tree, node);
    const std::vector<StableId> axis = axis_of(tree, node);
    double length = 0, before = 0;
    for (const StableId n : axis) {
        if (!tree.is_root(n)) length += distance(place_of(tree, n), place_of(tree, tree.parent(n)));
        if (n == node) before = length;
    }
    return {.id = node,
            .place = (tree.origin() + place_of(tree, node) - frame.base) / frame.size,
            .order = order_of(tree, node),
            .along = length > 0 ? before / length : 0,
            .length = length / frame.size,
            .radius = tree.radius(node) / frame.size};
}

Binding bind_anchor(const EditableTree& tree, const AnchorFrame& frame, const Anchor& anchor,
                    double tolerance) {
    constexpr double kThicker = 2;  // the greatest ratio of radii
    const Vec3d place = frame.base + anchor.place * frame.size - tree.origin();
    Binding out;
    double nearest = std::numeric_limits<double>::infinity(), best = nearest;
    bool other_order = false, other_radius = false;
    for (const StableId n : tree.nodes()) {
        const double away = distance(place_of(tree, n), place);
        if (away < nearest) {
            nearest = away;
            out.nearest = n;
        }
        if (away > tolerance * frame.size) continue;
        const Anchor here = anchor_of(tree, frame, n);
        const double thicker = std::abs(std::log(here.radius / anchor.radius));
        if (here.order != anchor.order) other_order = true;
        if (here.order == anchor.order && thicker > std::log(kThicker)) other_radius = true;
        if (here.order != anchor.order || thicker > std::log(kThicker)) continue;
        // Of two that are as like, the one that has the id.
        const double unlike = away / (tolerance * frame.size) + std::abs(here.along - anchor.along) +
                              std::abs(here.length - anchor.length) + 0.5 * thicker +
                              (n == anchor.id ? 0 : 1e-9);
        if (unlike < best) {
            best = unlike;
            out.node = n;
            out.distance = away;
        }
    }
    if (out.node) return out;
    out.distance = nearest;
    out.reason = other_radius  ? "the radius there is another"
                 : other_order ? "the order of the axis there is another"
                               : fmt::format("nothing is within {:.3g} m", tolerance * frame.size);
    return out;
}

}  // namespace coppice
