#include "coppice/edit/editable_tree.h"

#include <fmt/format.h>

#include <algorithm>
#include <functional>
#include <queue>

#include "coppice/base/error.h"
#include "coppice/base/sort.h"

namespace coppice {
namespace {

constexpr std::uint32_t kMaxIdsPerNode = 64, kAlwaysAllowedIds = 1u << 20;

}  // namespace

bool EditChange::empty() const {
    return added.empty() && removed.empty() && moved.empty() && resized.empty() && reparented.empty();
}

NodeSet EditChange::nodes() const {
    NodeSet out;
    for (const NodeSet* part : {&added, &removed, &moved, &resized, &reparented})
        out.insert(out.end(), part->begin(), part->end());
    sort_unique(out);
    return out;
}

EditableTree::EditableTree(const Skeleton& s) : origin_(s.origin()), size_(s.size()) {
    std::uint32_t slots = s.size();
    for (const StableId id : s.stable_ids()) slots = std::max(slots, id.index() + 1);
    if (slots > kAlwaysAllowedIds && slots / kMaxIdsPerNode > s.size()) {
        throw InvalidInput(
            fmt::format("the stable ids go up to {} for {} nodes; leave them out to number the nodes from 0",
                        slots - 1, s.size()));
    }
    resize(slots);
    for (const NodeId n : coppice::nodes(s)) {
        const StableId id = s.stable_id(n);
        if (!s.is_root(n)) parent_[id] = s.stable_id(s.parent(n));
        position_[id] = s.position(n);
        radius_[id] = s.radius(n);
    }
    // In descending order, so that each node is prepended to its siblings.
    for (std::uint32_t i = slots; i-- > 0;) {
        if (contains(StableId(i))) link(StableId(i));
    }
}

NodeSet EditableTree::nodes() const {
    NodeSet all;
    all.reserve(size_);
    for (std::uint32_t i = 0; i < slots(); ++i) {
        if (contains(StableId(i))) all.push_back(StableId(i));
    }
    return all;
}

Skeleton EditableTree::skeleton() const {
    NodeSet order = nodes();
    const bool parents_first =
        std::ranges::all_of(order, [&](StableId n) { return is_root(n) || parent_[n] < n; });
    if (!parents_first) {
        std::priority_queue<StableId, std::vector<StableId>, std::greater<>> ready;
        for (StableId n = first_root_; n; n = next_sibling_[n]) ready.push(n);
        for (order.clear(); !ready.empty();) {
            order.push_back(ready.top());
            ready.pop();
            for (StableId c = first_child_[order.back()]; c; c = next_sibling_[c]) ready.push(c);
        }
    }
    Column<StableId, NodeId> index(slots());
    std::vector<NodeId> parent;
    std::vector<Vec3> position;
    std::vector<float> radius;
    for (const StableId n : order) {
        index[n] = NodeId(static_cast<std::uint32_t>(parent.size()));
        parent.push_back(is_root(n) ? NodeId::none() : index[parent_[n]]);
        position.push_back(position_[n]);
        radius.push_back(radius_[n]);
    }
    const bool by_index = parents_first && slots() == size_;
    return Skeleton(std::move(parent), std::move(position), std::move(radius), origin_,
                    by_index ? std::vector<StableId>() : std::move(order));
}

StableId EditableTree::leader(StableId n) const {
    StableId leader = first_child_[n];
    for (StableId c = leader; c; c = next_sibling_[c]) {
        if (radius_[c] > radius_[leader]) leader = c;
    }
    return leader;
}

Segment EditableTree::segment(StableId n) const {
    const StableId p = parent_[n];
    COPPICE_ASSERT(p);
    return {position_[p], position_[n], leader(p) == n ? radius_[p] : radius_[n], radius_[n]};
}

StableId EditableTree::find_root(StableId n) const {
    while (parent_[n]) n = parent_[n];
    return n;
}

std::vector<StableId> EditableTree::subtree(StableId top) const {
    std::vector<StableId> all;
    visit_subtree(top, [&](StableId n) { all.push_back(n); });
    return all;
}

void EditableTree::resize(std::uint32_t slots) {
    parent_.resize(slots);
    first_child_.resize(slots);
    next_sibling_.resize(slots);
    position_.resize(slots);
    radius_.resize(slots);
}

/// Returns the link that points to n, or the position at which to insert it: after the siblings with smaller
/// ids.
StableId& EditableTree::link_before(StableId n) {
    StableId* at = parent_[n] ? &first_child_[parent_[n]] : &first_root_;
    while (*at < n) at = &next_sibling_[*at];
    return *at;
}

void EditableTree::link(StableId n) {
    StableId& before = link_before(n);
    next_sibling_[n] = before;
    before = n;
}

void EditableTree::unlink(StableId n) {
    StableId& before = link_before(n);
    COPPICE_ASSERT(before == n);
    before = next_sibling_[n];
    next_sibling_[n] = StableId::none();
}

/// Sets the states of the given nodes. All links that change are removed first, so that none points to a node
/// that does not exist.
void EditableTree::assign(const Nodes& nodes) {
    const auto links_change = [&](StableId n, const Node& to) {
        return parent_[n] != to.parent || (radius_[n] > 0) != (to.radius > 0);
    };
    std::vector<StableId> relinked;
    for (const auto& [n, to] : nodes) {
        if (!links_change(n, to)) continue;
        if (contains(n)) {
            unlink(n);
            --size_;
        }
        if (to.radius > 0) relinked.push_back(n);
    }
    for (const auto& [n, to] : nodes) {
        parent_[n] = to.parent;
        position_[n] = to.position;
        radius_[n] = to.radius;
    }
    for (const StableId n : relinked) {
        link(n);
        ++size_;
    }
}

EditChange EditableTree::change_from(const Nodes& before) const {
    EditChange change;
    for (const auto& [n, was] : before) {
        const Node is = n.index() < slots() ? node(n) : Node{};
        if (was.radius == 0 && is.radius == 0) continue;
        if (was.radius == 0) {
            change.added.push_back(n);
        } else if (is.radius == 0) {
            change.removed.push_back(n);
        } else {
            if (was.position != is.position) change.moved.push_back(n);
            if (was.radius != is.radius) change.resized.push_back(n);
            if (was.parent != is.parent) change.reparented.push_back(n);
        }
    }
    return change;
}

}  // namespace coppice
