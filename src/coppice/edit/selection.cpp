#include "coppice/edit/selection.h"

#include <fmt/format.h>

#include <algorithm>
#include <iterator>
#include <limits>
#include <utility>

#include "coppice/base/error.h"
#include "coppice/base/quote.h"
#include "coppice/base/sort.h"
#include "coppice/edit/anchor.h"
#include "coppice/edit/parts_internal.h"
#include "coppice/implicit/solid/solid_field.h"

namespace coppice {

using edit_internal::find_tops;

namespace {

Vec3d world(const EditableTree& tree, StableId n) { return tree.origin() + Vec3d(tree.position(n)); }

NodeSet sorted(NodeSet nodes) {
    sort_unique(nodes);
    return nodes;
}

template <class Asks>
NodeSet filtered(const EditableTree& tree, const Asks& asks) {
    NodeSet out = tree.nodes();
    std::erase_if(out, [&](StableId n) { return !asks(n); });
    return out;
}

bool within(const std::vector<double>& range, double value) {
    // Compares as float, like radii: 0.1 as a float is greater than 0.1 as a double.
    return static_cast<float>(value) >= static_cast<float>(range[0]) &&
           static_cast<float>(value) <= static_cast<float>(range[1]);
}

NodeSet by_order(const EditableTree& tree, const std::vector<double>& range) {
    Column<StableId, int> order(tree.slots());
    NodeSet out;
    for (StableId root = tree.first_root(); root; root = tree.next_sibling(root)) {
        tree.visit_subtree(root, [&](StableId n) {
            if (within(range, order[n])) out.push_back(n);
            const StableId leader = tree.leader(n);
            for (StableId c = tree.first_child(n); c; c = tree.next_sibling(c))
                order[c] = order[n] + (c == leader ? 0 : 1);
        });
    }
    return sorted(std::move(out));
}

NodeSet within_box(const EditableTree& tree, const std::vector<double>& corners) {
    return filtered(tree, [&](StableId n) {
        const Vec3d p = world(tree, n);
        for (int axis = 0; axis < 3; ++axis) {
            const double a = corners[static_cast<std::size_t>(axis)],
                         b = corners[static_cast<std::size_t>(axis) + 3];
            if (p[axis] < std::min(a, b) || p[axis] > std::max(a, b)) return false;
        }
        return true;
    });
}

NodeSet within_solid(const EditableTree& tree, const std::string& name, const SolidLookup& solids) {
    const Solid* solid = solids ? solids(name) : nullptr;
    if (solid == nullptr)
        throw InvalidInput(fmt::format("there is no solid {} to select by; create it first, as in: sphere {}",
                                       quote(name), shortened(name)));
    const NodeSet all = tree.nodes();
    std::vector<Vec3> points;
    for (const StableId n : all) points.push_back(Vec3(world(tree, n)));
    std::vector<float> values(points.size());
    SolidField(*solid).values(points, values);
    NodeSet out;
    for (std::size_t i = 0; i < all.size(); ++i) {
        if (values[i] >= Solid::kSurface) out.push_back(all[i]);
    }
    return out;
}

void add_of_id(const EditableTree& tree, SelectionKind kind, StableId id, NodeSet& out) {
    const auto add = [&](StableId n) { out.push_back(n); };
    check_node(tree, id);
    switch (kind) {
        case SelectionKind::subtree:
            return tree.visit_subtree(id, add);
        case SelectionKind::tree:
            return tree.visit_subtree(tree.find_root(id), add);
        case SelectionKind::axis:
            std::ranges::copy(find_axis(tree, id), std::back_inserter(out));
            return;
        case SelectionKind::path:
            for (StableId n = id; n; n = tree.parent(n)) add(n);
            return;
        case SelectionKind::children:
            for (StableId c = tree.first_child(id); c; c = tree.next_sibling(c)) add(c);
            return;
        default:
            return add(id);
    }
}

/// Returns the nodes without those that do not change the result of `kind`, without duplicates.
NodeSet without_repeats(const EditableTree& tree, SelectionKind kind, NodeSet nodes) {
    if (kind == SelectionKind::subtree) return sorted(find_tops(tree, nodes));
    for (StableId& n : nodes) {
        if (kind == SelectionKind::tree) n = tree.find_root(n);
        if (kind == SelectionKind::axis) n = find_axis(tree, n).front();
    }
    return sorted(std::move(nodes));
}

/// Returns the nodes on the paths from the nodes to their roots.
NodeSet paths_from(const EditableTree& tree, const NodeSet& nodes) {
    std::vector<bool> seen(tree.slots());
    NodeSet out;
    for (StableId n : nodes) {
        for (; n && !seen[n.index()]; n = tree.parent(n)) {
            seen[n.index()] = true;
            out.push_back(n);
        }
    }
    return sorted(std::move(out));
}

std::string place_text(Vec3d p) { return fmt::format("{:.6g},{:.6g},{:.6g}", p.x, p.y, p.z); }

StableId bound(const EditableTree& tree, const Selection& s) {
    const std::vector<double>& n = s.numbers;
    const AnchorFrame frame = anchor_frame(tree);
    Anchor anchor{.id = {},
                  .place = (Vec3d(n[0], n[1], n[2]) - frame.base) / frame.size,
                  .order = static_cast<int>(std::min(n[3], 1e9)),
                  .radius = n[4] / frame.size,
                  .knows_axis = n.size() > 6};
    if (anchor.knows_axis) {
        anchor.along = n[5];
        anchor.length = n[6] / frame.size;
    }
    if (n.size() > 8) anchor.id = StableId(static_cast<std::uint32_t>(n[8]));
    const double within = n.size() > 7 ? n[7] / frame.size : kAnchorTolerance;
    const Binding found = bind_anchor(tree, frame, anchor, std::min(within, kAnchorTolerance));
    if (!found.node) {
        throw InvalidInput(fmt::format("no node is like {}: {}; the nearest is node {} at {}, {:.3g} m away",
                                       to_text(s), found.reason, found.nearest.index(),
                                       place_text(world(tree, found.nearest)), found.distance));
    }
    if (found.twin) {
        throw InvalidInput(fmt::format(
            "nodes {} and {} are both like {}; enter all nine of its numbers, the last of which is the id",
            found.node.index(), found.twin.index(), to_text(s)));
    }
    return found.node;
}

NodeSet combined(const Selection& s, const EditableTree& tree, const SolidLookup& solids) {
    const NodeSet a = selected(tree, s.parts.at(0), solids);
    NodeSet out;
    if (s.kind == SelectionKind::without) {
        std::ranges::set_difference(tree.nodes(), a, std::back_inserter(out));
        return out;
    }
    const NodeSet b = selected(tree, s.parts.at(1), solids);
    if (s.kind == SelectionKind::both) {
        std::ranges::set_intersection(a, b, std::back_inserter(out));
    } else {
        std::ranges::set_union(a, b, std::back_inserter(out));
    }
    return out;
}

}  // namespace

void check_node(const EditableTree& tree, StableId n) {
    if (tree.contains(n)) return;
    throw InvalidInput(
        fmt::format("there is no node {}; {} ids from 0 to {} are in use, and select lists them", n.index(),
                    tree.size(), tree.slots() - 1));
}

std::vector<StableId> find_axis(const EditableTree& tree, StableId n) {
    while (!tree.is_root(n) && tree.leader(tree.parent(n)) == n) n = tree.parent(n);
    std::vector<StableId> axis{n};
    while (!tree.is_tip(axis.back())) axis.push_back(tree.leader(axis.back()));
    return axis;
}

int compute_order(const EditableTree& tree, StableId n) {
    int order = 0;
    for (; !tree.is_root(n); n = tree.parent(n)) order += tree.leader(tree.parent(n)) == n ? 0 : 1;
    return order;
}

StableId nearest_node(const EditableTree& tree, Vec3d place) {
    StableId best;
    double least = std::numeric_limits<double>::infinity();
    for (const StableId n : tree.nodes()) {
        const double squared = length_squared(world(tree, n) - place);
        if (squared < least || !best) {
            least = squared;
            best = n;
        }
    }
    COPPICE_ASSERT(best);
    return best;
}

NodeSet selected(const EditableTree& tree, const Selection& s, const SolidLookup& solids) {
    switch (s.kind) {
        case SelectionKind::all:
            return tree.nodes();
        case SelectionKind::roots:
            return filtered(tree, [&](StableId n) { return tree.is_root(n); });
        case SelectionKind::tips:
            return filtered(tree, [&](StableId n) { return tree.is_tip(n); });
        case SelectionKind::forks:
            return filtered(
                tree, [&](StableId n) { return !tree.is_tip(n) && tree.next_sibling(tree.first_child(n)); });
        case SelectionKind::order:
            return by_order(tree, s.numbers);
        case SelectionKind::radius:
            return filtered(tree, [&](StableId n) { return within(s.numbers, double{tree.radius(n)}); });
        case SelectionKind::height:
            return filtered(tree, [&](StableId n) { return within(s.numbers, world(tree, n).z); });
        case SelectionKind::box:
            return within_box(tree, s.numbers);
        case SelectionKind::solid:
            return within_solid(tree, s.name, solids);
        case SelectionKind::near:
            return {nearest_node(tree, {s.numbers[0], s.numbers[1], s.numbers[2]})};
        case SelectionKind::at:
            return {bound(tree, s)};
        case SelectionKind::both:
        case SelectionKind::either:
        case SelectionKind::without:
            return combined(s, tree, solids);
        default:
            break;
    }
    NodeSet ids = s.ids, out;
    if (!s.parts.empty()) {
        ids = selected(tree, s.parts[0], solids);
        if (s.kind == SelectionKind::path) return paths_from(tree, ids);
        ids = without_repeats(tree, s.kind, std::move(ids));
    }
    for (const StableId id : ids) add_of_id(tree, s.kind, id, out);
    return sorted(std::move(out));
}

StableId selected_node(const EditableTree& tree, const Selection& selection, const SolidLookup& solids) {
    const NodeSet nodes = selected(tree, selection, solids);
    if (nodes.size() != 1) {
        throw InvalidInput(
            fmt::format("{} contains {} nodes where one is needed; name its id, or use near(x,y,z)",
                        quote(to_text(selection)), nodes.size()));
    }
    return nodes.front();
}

}  // namespace coppice
