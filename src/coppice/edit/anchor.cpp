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
    return {tree.origin() + get_position(tree, tree.first_root()), extent > 0 ? extent : 1};
}

Anchor compute_anchor(const EditableTree& tree, const AnchorFrame& frame, StableId node) {
    check_node(tree, node);
    const std::vector<StableId> axis = find_axis(tree, node);
    double length = 0, before = 0;
    for (const StableId n : axis) {
        if (!tree.is_root(n)) length += distance(get_position(tree, n), get_position(tree, tree.parent(n)));
        if (n == node) before = length;
    }
    return {.id = node,
            .place = (tree.origin() + get_position(tree, node) - frame.base) / frame.size,
            .order = compute_order(tree, node),
            .along = length > 0 ? before / length : 0,
            .length = length / frame.size,
            .radius = tree.radius(node) / frame.size};
}

namespace {

/// A node that may correspond to an anchor.
struct Candidate {
    StableId node;
    double away = 0;  // [m]
};

/// Returns the dissimilarity between the axis of a node and the axis of an anchor.
double unlike_axis(const EditableTree& tree, const AnchorFrame& frame, StableId node, const Anchor& anchor) {
    if (!anchor.knows_axis) return 0;
    const Anchor here = compute_anchor(tree, frame, node);
    return std::abs(here.along - anchor.along) + std::abs(here.length - anchor.length);
}

/// Returns the nodes within a distance of a position, sorted by distance; stores the closest node of all in
/// `out`.
std::vector<Candidate> candidates(const EditableTree& tree, Vec3d place, double within, Binding& out) {
    std::vector<Candidate> near;
    double nearest = std::numeric_limits<double>::infinity();
    for (const StableId n : tree.nodes()) {
        const double squared = length_squared(get_position(tree, n) - place);
        if (squared < nearest) {
            nearest = squared;
            out.nearest = n;
        }
        if (const double away = std::sqrt(squared); away <= within) near.push_back({n, away});
    }
    out.distance = std::sqrt(nearest);
    std::ranges::sort(near, [](const Candidate& a, const Candidate& b) {
        return std::pair(a.away, a.node) < std::pair(b.away, b.node);
    });
    return near;
}

}  // namespace

Binding bind_anchor(const EditableTree& tree, const AnchorFrame& frame, const Anchor& anchor,
                    double tolerance) {
    constexpr double kOtherId = 1e-9, kSame = 1e-12;
    const Vec3d place = frame.base + anchor.place * frame.size - tree.origin();
    const double within = tolerance * frame.size;
    Binding out;
    double best = std::numeric_limits<double>::infinity();
    bool other_order = false, other_radius = false;
    for (const Candidate& c : candidates(tree, place, within, out)) {
        const double by_place = c.away / within;
        if (by_place > best + kOtherId) break;
        const double thicker = std::abs(std::log(tree.radius(c.node) / frame.size / anchor.radius));
        if (compute_order(tree, c.node) != anchor.order) {
            other_order = true;
            continue;
        }
        if (thicker > std::log(kAnchorThicker)) {
            other_radius = true;
            continue;
        }
        const double axis = unlike_axis(tree, frame, c.node, anchor);
        // Of two equally similar nodes, the one with the id of the anchor is preferred.
        const double unlike = by_place + axis + 0.5 * thicker + (c.node == anchor.id ? 0 : kOtherId);
        if (std::abs(unlike - best) < kSame) out.twin = c.node;
        if (unlike > best - kSame) continue;
        best = unlike;
        out.twin = {};
        out.node = c.node;
        out.distance = c.away;
    }
    if (out.node) return out;
    out.reason = other_radius  ? "the radius there is different"
                 : other_order ? "the order of the axis there is different"
                               : fmt::format("no node is within {:.3g} m", within);
    return out;
}

}  // namespace coppice
