#include "coppice/pipeline/live/patch_store_internal.h"

#include <algorithm>
#include <array>
#include <tuple>

#include "coppice/base/id.h"
#include "coppice/base/sort.h"
#include "coppice/pipeline/live/edit_zone_internal.h"

namespace coppice::pipeline_internal {
namespace {

constexpr Quad kFreeQuad{0, 0, 0, 0};

std::vector<StableId> collect_ids(const TracedPortion& traced, std::span<const NodeId> nodes) {
    std::vector<StableId> out;
    for (const NodeId n : nodes) out.push_back(traced.part.stable_id(n));
    std::sort(out.begin(), out.end());
    return out;
}

// Sorts ranges and joins those that touch.
void tidy(std::vector<NumberRange>& ranges) {
    std::ranges::sort(ranges, {}, &NumberRange::first);
    std::vector<NumberRange> out;
    for (const NumberRange& r : ranges) {
        if (r.count == 0) continue;
        if (!out.empty() && r.first <= out.back().first + out.back().count) {
            out.back().count = std::max(out.back().count, r.first + r.count - out.back().first);
        } else {
            out.push_back(r);
        }
    }
    ranges = std::move(out);
}

}  // namespace

std::uint32_t FreeRanges::take(std::uint32_t count) {
    if (const auto at = by_count_.find(count); at != by_count_.end() && !at->second.empty()) {
        const std::uint32_t first = at->second.back();
        at->second.pop_back();
        free_ -= count;
        return first;
    }
    const std::uint32_t first = end_;
    end_ += count;
    return first;
}

void FreeRanges::give(NumberRange range) {
    if (range.count == 0) return;
    by_count_[range.count].push_back(range.first);
    free_ += range.count;
}

std::vector<std::uint32_t>& PatchStore::row(std::vector<std::vector<std::uint32_t>>& rows, StableId node) {
    if (node.index() >= rows.size()) rows.resize(std::size_t{node.index()} + 1);
    return rows[node.index()];
}

std::span<const std::uint32_t> PatchStore::row(const std::vector<std::vector<std::uint32_t>>& rows,
                                               StableId node) const {
    if (node.index() >= rows.size()) return {};
    return rows[node.index()];
}

std::uint32_t PatchStore::stored_tube(StableId node, std::uint32_t place) const {
    const auto tubes = row(tubes_of_, node);
    return place < tubes.size() ? tubes[place] : kNoIndex;
}

// Returns the stored index of a traced vertex, if its patch is stored; otherwise none.
std::uint32_t PatchStore::slot(const TracedPortion& traced, const Plan& plan, std::uint32_t vertex) const {
    const std::uint32_t stored = plan.kept[traced.patches.owner[vertex]];
    return stored == kNoIndex ? kNoIndex : patches_[stored].vertices.first + traced.patches.local[vertex];
}

bool PatchStore::differs(const TracedPortion& traced, NodeId n) const {
    const SurfacePatches& patches = traced.patches;
    const auto stored = row(tubes_of_, traced.part.stable_id(n));
    const auto tubes = patches.tubes_of[n.index()];
    const auto is_same = [&](std::uint32_t t, std::uint32_t there) {
        const auto at = patches.vertices[t];
        const NumberRange range = patches_[there].vertices;
        return std::equal(at.begin(), at.end(), positions_.begin() + range.first,
                          positions_.begin() + range.first + range.count,
                          [&](std::uint32_t v, Vec3 p) { return patches.positions[v] == p; });
    };
    return !std::equal(tubes.begin(), tubes.end(), stored.begin(), stored.end(), is_same);
}

// Returns whether a traced patch has the positions and quads of a stored one, with its own vertices.
bool PatchStore::is_same(const TracedPortion& traced, const Plan& plan, std::uint32_t traced_patch,
                         std::uint32_t stored) const {
    const Patch& there = patches_[stored];
    const auto vertices = traced.patches.vertices[traced_patch];
    const auto quads = traced.patches.quads_of[traced_patch];
    if (vertices.size() != there.vertices.count || quads.size() != there.quads.count) return false;
    for (std::size_t i = 0; i < vertices.size(); ++i) {
        if (!(positions_[there.vertices.first + i] == traced.patches.positions[vertices[i]])) return false;
    }
    for (std::size_t i = 0; i < quads.size(); ++i) {
        const Quad& q = quads_[there.quads.first + i];
        const Quad& now = traced.patches.quads[quads[i]];
        for (std::size_t k = 0; k < q.size(); ++k) {
            const bool is_own = traced.patches.owner[now[k]] == traced_patch;
            const std::uint32_t at =
                is_own ? there.vertices.first + traced.patches.local[now[k]] : slot(traced, plan, now[k]);
            if (q[k] != at) return false;
        }
    }
    return true;
}

// Extends the nodes to check by those that a new repair patch covers, unless unchecked patches are there.
void PatchStore::widen(const TracedPortion& traced, Plan& plan) const {
    const SurfacePatches& patches = traced.patches;
    const NodeIndex at(traced.part);
    const auto miss = [&](NodeId n) { plan.missing.push_back(traced.part.stable_id(n)); };
    for (std::size_t i = 0; i < patches.piece_nodes.size(); ++i) {
        for (const NodeId n : patches.piece_needs[i]) {
            if (!traced.is_trusted(n)) miss(n);
        }
        for (const NodeId n : patches.piece_nodes[i]) {
            if (plan.is_wanted[n.index()] != 0) continue;
            plan.is_wanted[n.index()] = 1;
            const StableId own = traced.part.stable_id(n);
            visit_pieces(own, [&](auto covered, auto) {
                if (!std::ranges::binary_search(covered, own)) return;
                for (const StableId id : covered) {
                    if (!at[id] || !traced.is_wanted(at[id])) plan.missing.push_back(id);
                }
            });
        }
    }
}

void PatchStore::plan_tubes(const TracedPortion& traced, Plan& plan) const {
    const SurfacePatches& patches = traced.patches;
    for (std::uint32_t t = 0; t < patches.tube_count(); ++t)
        plan.kept[t] = stored_tube(traced.part.stable_id(patches.node[t]), patches.place[t]);
    for (const NodeId n : nodes(traced.part)) {
        if (plan.is_wanted[n.index()] == 0) continue;
        const auto tubes = patches.tubes_of[n.index()];
        for (const std::uint32_t t : tubes) {
            if (plan.kept[t] == kNoIndex || !is_same(traced, plan, t, plan.kept[t])) plan.is_new[t] = 1;
        }
        const auto stored = row(tubes_of_, traced.part.stable_id(n));
        for (std::size_t i = tubes.size(); i < stored.size(); ++i) plan.removed.push_back(stored[i]);
    }
}

void PatchStore::plan_pieces(const TracedPortion& traced, std::span<const StableId> removed,
                             Plan& plan) const {
    const SurfacePatches& patches = traced.patches;
    std::vector<std::uint32_t> still_there;
    for (std::uint32_t i = 0; i < patches.piece_nodes.size(); ++i) {
        const std::uint32_t patch = patches.tube_count() + i;
        const std::vector<StableId> ids = collect_ids(traced, patches.piece_nodes[i]);
        for (const std::uint32_t stored : row(pieces_of_, ids[0])) {
            if (patches_[stored].nodes == ids && is_same(traced, plan, patch, stored)) {
                plan.kept[patch] = stored;
                still_there.push_back(stored);
            }
        }
        plan.is_new[patch] = plan.kept[patch] == kNoIndex ? 1 : 0;
    }
    std::ranges::sort(still_there);
    // Removes checked repair patches that no longer exist; those of unchecked nodes are kept.
    const NodeIndex at(traced.part);
    std::vector<std::uint32_t> gone;
    const auto look_at = [&](StableId own) {
        for (const std::uint32_t stored : row(pieces_of_, own)) {
            const auto& covered = patches_[stored].nodes;
            if (!std::ranges::binary_search(covered, own) || std::ranges::binary_search(still_there, stored))
                continue;
            gone.push_back(stored);
            for (const StableId id : covered) {
                const bool may_go = std::ranges::binary_search(removed, id) ||
                                    (at[id] && plan.is_wanted[at[id].index()] != 0);
                if (!may_go) plan.missing.push_back(id);
            }
        }
    };
    for (const NodeId n : nodes(traced.part)) {
        if (plan.is_wanted[n.index()] != 0) look_at(traced.part.stable_id(n));
    }
    for (const StableId id : removed) look_at(id);
    sort_unique(gone);
    plan.removed.insert(plan.removed.end(), gone.begin(), gone.end());
}

// Quads that will not be written must not refer to vertices that move to another index.
void PatchStore::find_moves_under_others(const TracedPortion& traced, Plan& plan) const {
    const SurfacePatches& patches = traced.patches;
    std::vector<std::uint8_t> moves(patches.count(), 0);
    for (std::uint32_t p = 0; p < patches.count(); ++p) {
        moves[p] =
            plan.is_new[p] != 0 &&
            (plan.kept[p] == kNoIndex || patches_[plan.kept[p]].vertices.count != patches.vertices[p].size());
    }
    for (std::uint32_t t = 0; t < patches.tube_count(); ++t) {
        if (plan.is_wanted[patches.node[t].index()] != 0) continue;
        const bool refers = std::ranges::any_of(patches.quads_of[t], [&](std::uint32_t q) {
            return std::ranges::any_of(traced.patches.quads[q],
                                       [&](std::uint32_t v) { return moves[patches.owner[v]] != 0; });
        });
        if (refers) plan.missing.push_back(traced.part.stable_id(patches.node[t]));
    }
}

PatchStore::Plan PatchStore::plan(const TracedPortion& traced, std::span<const StableId> removed) const {
    Plan out{std::vector<std::uint32_t>(traced.patches.count(), kNoIndex),
             std::vector<std::uint8_t>(traced.patches.count(), 0),
             {},
             {traced.wanted.begin(), traced.wanted.end()},
             {}};
    for (const StableId id : removed) {
        for (const std::uint32_t tube : row(tubes_of_, id)) out.removed.push_back(tube);
    }
    widen(traced, out);
    plan_tubes(traced, out);
    plan_pieces(traced, removed, out);
    find_moves_under_others(traced, out);
    return out;
}

void PatchStore::remove(std::uint32_t patch, SurfaceChange& change) {
    Patch& p = patches_[patch];
    if (p.needs.empty()) std::erase(row(tubes_of_, p.nodes[0]), patch);
    for (const StableId id : p.needs) std::erase(row(pieces_of_, id), patch);
    std::fill_n(quads_.begin() + p.quads.first, p.quads.count, kFreeQuad);
    change.quads.push_back(p.quads);
    free_vertices_.give(p.vertices);
    free_quads_.give(p.quads);
    p = {};
    free_patches_.push_back(patch);
}

std::uint32_t PatchStore::add_patch() {
    if (free_patches_.empty()) {
        patches_.emplace_back();
        return static_cast<std::uint32_t>(patches_.size() - 1);
    }
    const std::uint32_t patch = free_patches_.back();
    free_patches_.pop_back();
    return patch;
}

// Assigns ranges to a patch, and writes its positions.
void PatchStore::place(const TracedPortion& traced, Plan& plan, std::uint32_t traced_patch,
                       SurfaceChange& change) {
    const SurfacePatches& patches = traced.patches;
    std::uint32_t& stored = plan.kept[traced_patch];
    if (stored == kNoIndex) {
        stored = add_patch();
        if (traced_patch < patches.tube_count()) {
            const StableId id = traced.part.stable_id(patches.node[traced_patch]);
            patches_[stored].nodes = {id};
            row(tubes_of_, id).push_back(stored);
        } else {
            const std::uint32_t repair_patch = traced_patch - patches.tube_count();
            patches_[stored].nodes = collect_ids(traced, patches.piece_nodes[repair_patch]);
            patches_[stored].needs = collect_ids(traced, patches.piece_needs[repair_patch]);
            for (const StableId id : patches_[stored].needs) row(pieces_of_, id).push_back(stored);
        }
    }
    Patch& p = patches_[stored];
    const auto vertices = patches.vertices[traced_patch];
    const auto fit = [](NumberRange& range, std::size_t count, FreeRanges& free) {
        if (range.count == count) return;
        free.give(range);
        range.count = static_cast<std::uint32_t>(count);
        range.first = free.take(range.count);
    };
    const NumberRange quads_before = p.quads;
    fit(p.vertices, vertices.size(), free_vertices_);
    fit(p.quads, patches.quads_of[traced_patch].size(), free_quads_);
    positions_.resize(free_vertices_.end());
    quads_.resize(free_quads_.end(), kFreeQuad);
    if (p.quads.first != quads_before.first) {
        std::fill_n(quads_.begin() + quads_before.first, quads_before.count, kFreeQuad);
        change.quads.push_back(quads_before);
    }
    for (std::size_t i = 0; i < vertices.size(); ++i)
        positions_[p.vertices.first + i] = traced.patches.positions[vertices[i]];
    change.vertices.push_back(p.vertices);
}

// Writes the quads of a patch if they changed.
void PatchStore::write_quads(const TracedPortion& traced, const Plan& plan, std::uint32_t traced_patch,
                             SurfaceChange& change) {
    const Patch& p = patches_[plan.kept[traced_patch]];
    bool differs = false;
    std::size_t at = p.quads.first;
    for (const std::uint32_t q : traced.patches.quads_of[traced_patch]) {
        Quad now = traced.patches.quads[q];
        for (std::uint32_t& v : now) v = slot(traced, plan, v);
        differs |= quads_[at] != now;
        quads_[at++] = now;
    }
    if (differs) change.quads.push_back(p.quads);
}

Merged PatchStore::merge(const TracedPortion& traced, std::span<const StableId> removed) {
    Plan made = plan(traced, removed);
    if (!made.missing.empty()) return {{}, std::move(made.missing)};
    SurfaceChange change;
    for (const std::uint32_t patch : made.removed) remove(patch, change);
    const std::uint32_t count = traced.patches.count();
    for (std::uint32_t p = 0; p < count; ++p) {
        if (made.is_new[p] != 0) place(traced, made, p, change);
    }
    // Neighbours of moved patches refer to them.
    for (std::uint32_t p = 0; p < count; ++p) {
        const bool is_tile = p >= traced.patches.tube_count();
        if (is_tile || made.is_wanted[traced.patches.node[p].index()] != 0)
            write_quads(traced, made, p, change);
    }
    tidy(change.vertices);
    tidy(change.quads);
    return {std::move(change), {}};
}

bool PatchStore::is_sparse() const {
    return std::size_t{2} * free_quads_.free() > quads_.size() ||
           std::size_t{2} * free_vertices_.free() > positions_.size();
}

QuadMesh PatchStore::compact() const {
    std::vector<std::uint32_t> order;
    for (std::uint32_t id = 0; id < std::max(tubes_of_.size(), pieces_of_.size()); ++id) {
        const auto tubes = row(tubes_of_, StableId(id));
        order.insert(order.end(), tubes.begin(), tubes.end());
        const std::size_t first = order.size();
        for (const std::uint32_t repair_patch : row(pieces_of_, StableId(id))) {
            if (patches_[repair_patch].nodes[0] == StableId(id)) order.push_back(repair_patch);
        }
        std::sort(order.begin() + static_cast<std::ptrdiff_t>(first), order.end(),
                  [&](std::uint32_t a, std::uint32_t b) {
                      const auto key = [&](std::uint32_t p) {
                          const Vec3 x = positions_[patches_[p].vertices.first];
                          return std::tuple(patches_[p].nodes, x.x, x.y, x.z);
                      };
                      return key(a) < key(b);
                  });
    }
    QuadMesh out;
    std::vector<std::uint8_t> is_used(positions_.size(), 0);
    for (const std::uint32_t p : order) {
        const NumberRange q = patches_[p].quads;
        for (std::uint32_t i = q.first; i < q.first + q.count; ++i) {
            for (const std::uint32_t v : quads_[i]) is_used[v] = 1;
        }
    }
    std::vector<std::uint32_t> place(positions_.size(), kNoIndex);
    for (const std::uint32_t p : order) {
        const NumberRange v = patches_[p].vertices;
        for (std::uint32_t i = v.first; i < v.first + v.count; ++i) {
            if (is_used[i] == 0) continue;
            place[i] = static_cast<std::uint32_t>(out.positions.size());
            out.positions.push_back(positions_[i]);
        }
    }
    for (const std::uint32_t p : order) {
        const NumberRange q = patches_[p].quads;
        for (std::uint32_t i = q.first; i < q.first + q.count; ++i) {
            Quad quad = quads_[i];
            for (std::uint32_t& v : quad) v = place[v];
            out.quads.push_back(quad);
        }
    }
    return out;
}

}  // namespace coppice::pipeline_internal
