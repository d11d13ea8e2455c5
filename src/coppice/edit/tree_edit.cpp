#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "coppice/base/error.h"
#include "coppice/edit/editable_tree.h"
#include "coppice/edit/motion_internal.h"

namespace coppice {
namespace {

constexpr float kMax = 1e15f, kMinRadius = 1e-12f;  // same limits as the file readers

bool is_sound(Vec3 p) {
    return is_finite(p) && std::max({std::abs(p.x), std::abs(p.y), std::abs(p.z)}) <= kMax;
}

}  // namespace

TreeEdit::TreeEdit(EditableTree& tree)
    : tree_(tree), slots_before_(tree.slots()), moves_(std::make_unique<EditableTree::Moves>()) {}

TreeEdit::~TreeEdit() {
    if (committed_) return;
    tree_.assign(before());
    tree_.resize(slots_before_);
}

/// Records the state of a node before the edit; only the first record counts.
void TreeEdit::touch(StableId n) {
    COPPICE_ASSERT(tree_.contains(n));
    if (n.index() >= slots_before_) return;  // it did not exist before
    if (!before_.empty() && before_.back().first == n) return;
    if (!before_.empty() && n < before_.back().first) sorted_ = false;
    before_.emplace_back(n, tree_.node(n));
}

/// Returns the states of all touched nodes before the edit, including new ones, in order of id.
EditableTree::Nodes TreeEdit::before() {
    if (!sorted_) {
        std::ranges::stable_sort(before_, {}, [](const auto& entry) { return entry.first; });
        sorted_ = true;
    }
    const auto same = [](const auto& a, const auto& b) { return a.first == b.first; };
    before_.erase(std::unique(before_.begin(), before_.end(), same), before_.end());
    EditableTree::Nodes all = before_;
    for (std::uint32_t i = slots_before_; i < tree_.slots(); ++i)
        all.emplace_back(StableId(i), EditableTree::Node{});
    return all;
}

StableId TreeEdit::add(StableId parent, Vec3 position, float radius) {
    COPPICE_ASSERT(!parent || tree_.contains(parent));
    const StableId n(tree_.slots());
    if (!(radius > 0) || !std::isfinite(radius))
        throw InvalidInput(fmt::format("a new node would get the radius {}; enter a radius above 0", radius));
    tree_.resize(tree_.slots() + 1);
    tree_.assign({{n, {parent, position, radius}}});
    return n;
}

void TreeEdit::remove(StableId tip) {
    touch(tip);
    COPPICE_ASSERT(tree_.is_tip(tip));
    tree_.assign({{tip, {}}});
}

void TreeEdit::remove_subtree(StableId n) {
    EditableTree::Nodes gone;
    const std::vector<StableId> all = tree_.subtree(n);
    for (auto at = all.rbegin(); at != all.rend(); ++at) {  // tips first
        touch(*at);
        gone.push_back({*at, {}});
    }
    tree_.assign(gone);
}

void TreeEdit::move(StableId n, Vec3 position) {
    touch(n);
    tree_.position_[n] = position;
}

void TreeEdit::move_subtree(StableId n, const edit_internal::Motion& motion) {
    EditableTree::Moves& moves = *moves_;
    if (moves.motions.empty() || moves.motions.back() != motion) moves.motions.push_back(motion);
    const auto number = static_cast<std::uint32_t>(moves.motions.size() - 1);
    tree_.visit_subtree(n, [&](StableId below) {
        move(below, edit_internal::moved(motion, tree_.position(below)));
        moves.followers.emplace_back(below, number);
        if (motion.factor > 0) turn(below, motion.turn);
    });
}

void TreeEdit::set_radius(StableId n, float radius) {
    touch(n);
    if (!(radius > 0) || !std::isfinite(radius))
        throw InvalidInput(
            fmt::format("node {} would get the radius {}; enter a radius above 0", n.index(), radius));
    tree_.radius_[n] = radius;
}

void TreeEdit::turn(StableId n, const Rotation& by) {
    if (!tree_.turn_.empty()) turns_.emplace_back(n, by);
}

void TreeEdit::set_parent(StableId n, StableId parent) {
    COPPICE_ASSERT(!parent || tree_.contains(parent));
    for (StableId above = parent; above; above = tree_.parent(above)) {
        if (above != n) continue;
        throw InvalidInput(
            fmt::format("node {0} hangs on node {1}, so {1} cannot hang on {0}: that would be a cycle; "
                        "choose a node outside the subtree of {1}",
                        parent.index(), n.index()));
    }
    touch(n);
    tree_.assign({{n, {parent, tree_.position(n), tree_.radius(n)}}});
}

EditChange TreeEdit::commit() {
    const EditableTree::Nodes was = before();
    check(was);
    EditChange change = tree_.change_from(was);
    if (change.empty()) {
        tree_.resize(slots_before_);
    } else {
        tree_.remember(tree_.delta_from(was, slots_before_, std::move(*moves_)));
    }
    for (const auto& [n, by] : turns_) {
        if (n.index() < tree_.turn_.size()) tree_.turn_[n.index()] = by * tree_.turn_[n.index()];
    }
    committed_ = true;
    return change;
}

void TreeEdit::check(const EditableTree::Nodes& before) const {
    if (tree_.size() == 0) throw InvalidInput("no node would remain; keep at least one");
    for (const auto& [n, was] : before) {
        if (!tree_.contains(n)) continue;
        if (!is_sound(tree_.position(n))) {
            throw InvalidInput(fmt::format(
                "node {} would get a position that is not finite or beyond 1e15 m; move it less far",
                n.index()));
        }
        if (!(tree_.radius(n) >= kMinRadius && tree_.radius(n) <= kMax)) {
            throw InvalidInput(fmt::format("node {} would get the radius {}; enter one from 1e-12 to 1e15 m",
                                           n.index(), tree_.radius(n)));
        }
        check_place(n, before);
        for (StableId c = tree_.first_child(n); c; c = tree_.next_sibling(c)) check_place(c, before);
    }
}

/// Throws InvalidInput if n coincides with its parent or a sibling and did not so before.
void TreeEdit::check_place(StableId n, const EditableTree::Nodes& before) const {
    const auto was = [&](StableId m) {
        const auto found =
            std::ranges::lower_bound(before, m, {}, [](const auto& entry) { return entry.first; });
        return found != before.end() && found->first == m ? found->second : tree_.node(m);
    };
    const StableId parent = tree_.parent(n);
    if (!parent) return;
    const Vec3 p = tree_.position(n);
    const auto refuse = [&](StableId other, const char* subject) {
        const EditableTree::Node a = was(n), b = was(other);
        if (a.radius > 0 && b.radius > 0 && a.parent == parent && a.position == b.position) return;
        throw InvalidInput(
            fmt::format("node {} would coincide with its {} {}; move it elsewhere, or delete one of them",
                        n.index(), subject, other.index()));
    };
    if (p == tree_.position(parent)) refuse(parent, "parent");
    for (StableId s = tree_.first_child(parent); s; s = tree_.next_sibling(s)) {
        if (s != n && p == tree_.position(s)) refuse(s, "sibling");
    }
}

}  // namespace coppice
