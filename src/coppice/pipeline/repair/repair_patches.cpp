#include "coppice/pipeline/repair/repair_patches_internal.h"

#include <algorithm>
#include <cmath>

#include "coppice/base/id.h"
#include "coppice/base/parallel.h"

namespace coppice::pipeline_internal {
namespace {

constexpr std::size_t kMaxOptional = 64;  // rows of a patch that is created only for severed axes
constexpr int kMaxAttempts = 30;
constexpr float kLongestStep = 6;  // [radii]
constexpr float kHaste = 1.5f;  // growth factor of the steps by which groups grow, beginning with one radius
constexpr std::size_t kQuadGrain = 4096;
constexpr std::size_t kLarge = 400;  // number of rows from which a patch is computed by all threads

// A patch of the skeleton has no points of its own to fit global weights to.
MeshOptions with_local_weights(MeshOptions options) {
    options.field.weights = Weights::local;
    return options;
}

// Calls make(i, ctx) for some groups.
template <class GroupOf, class Make>
void make_each(std::span<const std::uint32_t> which, const GroupOf& group, const Context& ctx,
               const Make& make) {
    const auto is_large = [&](std::size_t k) { return group(which[k]).tube_rows.size() >= kLarge; };
    parallel_for_uneven(ctx, which.size(), 1, is_large,
                        [&](std::size_t k, const Context& c) { make(which[k], c); });
}

// Removes the quads of removed rows; returns their vertices.
NumberSet drop_gone(QuadMesh& mesh, const TubeRows& tube_rows, const RemovedRows& removed) {
    std::vector<std::uint8_t> is_touched(tube_rows.tubes().size(), 0);
    for (const TubeRow s : removed.marked()) is_touched[tube_rows.tube(s).index()] = 1;
    NumberSet gone(mesh.positions.size());
    std::size_t kept = 0;
    const std::uint32_t per_face = 1u << (2 * tube_rows.levels());
    const auto count = static_cast<std::uint32_t>(tube_rows.cage().region.size());
    for (std::uint32_t f = 0, q = 0; f < count; ++f) {
        if (is_touched[tube_rows.get_tube(f).index()] == 0) {
            std::copy_n(mesh.quads.begin() + q, per_face,
                        mesh.quads.begin() + static_cast<std::ptrdiff_t>(kept));
            kept += per_face;
            q += per_face;
            continue;
        }
        for (const std::uint32_t end = q + per_face; q < end; ++q) {
            if (removed.contains(tube_rows.of_quad(q))) {
                for (const std::uint32_t v : mesh.quads[q]) gone.add(v);
            } else {
                mesh.quads[kept++] = mesh.quads[q];
            }
        }
    }
    mesh.quads.resize(kept);
    return gone;
}

// Removes some vertices and renumbers the others.
void drop_vertices(QuadMesh& mesh, const NumberSet& gone, const Context& ctx) {
    std::size_t kept = 0, begin = 0;
    const auto keep = [&](std::size_t end) {
        std::copy(mesh.positions.data() + begin, mesh.positions.data() + end, mesh.positions.data() + kept);
        kept += end - begin;
        begin = end + 1;
    };
    for (const std::uint32_t v : gone.ascending()) keep(v);
    keep(mesh.positions.size());
    mesh.positions.resize(kept);
    parallel_for(ctx, mesh.quads.size(), kQuadGrain, [&](std::size_t q) {
        for (std::uint32_t& v : mesh.quads[q]) v -= gone.rank(v);
    });
}

}  // namespace

RepairPatches::RepairPatches(const QuadBuild& build, const TubeRows& tube_rows, const QuadMesh& mesh,
                             const Context& ctx)
    : mesh_(mesh),
      options_(with_local_weights(build.options)),
      ctx_(ctx),
      skeletons_(build, tube_rows),
      owner_(tube_rows.count(), kNoIndex) {}

void RepairPatches::make(RemovedRows& removed, std::span<const RepairLevel> repair_level) {
    for (int attempt = 0;; ++attempt) {
        ctx_.throw_if_cancelled();
        removed.close();
        follow(removed.groups());
        if (!grow_to_fit(removed, attempt)) break;
    }
    std::vector<std::uint32_t> stale;
    for (std::uint32_t i = 0; i < repair_patches_.size(); ++i) {
        if (!repair_patches_[i]->is_current) stale.push_back(i);
    }
    const auto get_group = [&](std::uint32_t i) -> const RowGroup& {
        return repair_patches_[i]->surface.group;
    };
    make_each(stale, get_group, ctx_, [&](std::uint32_t i, const Context& ctx) {
        RepairPatch& p = *repair_patches_[i];
        make_quads(p.quads, p.surface, repair_level, options_, ctx);
        p.is_current = true;
    });
}

// Creates patches for these groups; unchanged groups keep theirs.
void RepairPatches::follow(std::vector<RowGroup> groups) {
    std::vector<std::unique_ptr<RepairPatch>> repair_patches(groups.size());
    std::vector<std::uint32_t> changed;
    for (std::uint32_t g = 0; g < groups.size(); ++g) {
        const std::uint32_t before = owner_[groups[g].tube_rows[0]];
        if (before != kNoIndex && repair_patches_[before] &&
            repair_patches_[before]->surface.group.tube_rows == groups[g].tube_rows) {
            repair_patches[g] = std::move(repair_patches_[before]);
            continue;
        }
        changed.push_back(g);
    }
    const auto get_group = [&](std::uint32_t g) -> const RowGroup& { return groups[g]; };
    make_each(changed, get_group, ctx_, [&](std::uint32_t g, const Context& ctx) {
        auto made = made_for(groups[g]);
        repair_patches[g] = std::make_unique<RepairPatch>(RepairPatch{
            patch_surface(std::move(groups[g]), std::move(made), skeletons_, mesh_, options_, ctx), {}});
    });
    for (const std::uint32_t g : changed) {
        const auto& made = repair_patches[g]->surface.marched;
        if (!largest_ || made->segments.size() > largest_->segments.size()) largest_ = made;
    }
    repair_patches_ = std::move(repair_patches);
    std::fill(owner_.begin(), owner_.end(), kNoIndex);
    for (std::uint32_t i = 0; i < repair_patches_.size(); ++i) {
        for (const TubeRow s : repair_patches_[i]->surface.group.tube_rows) owner_[s] = i;
    }
}

// Returns the level set of the patch that has the most rows in common with a group; or the largest one so far
// if only that contains the group, and the group is a large part of it.
std::shared_ptr<const Marched> RepairPatches::made_for(const RowGroup& group) const {
    std::vector<std::uint32_t> count(repair_patches_.size(), 0);
    std::uint32_t most = 0;
    std::shared_ptr<const Marched> best;
    for (const TubeRow s : group.tube_rows) {
        const std::uint32_t i = owner_[s];
        if (i == kNoIndex || !repair_patches_[i] || ++count[i] <= most) continue;
        most = count[i];
        best = repair_patches_[i]->surface.marched;
    }
    if (!largest_ || largest_ == best || largest_->is_impossible) return best;
    const std::vector<NodeId> needed = skeletons_.needed(group);
    const bool is_large = needed.size() >= largest_->segments.size() / 4;
    return is_large && largest_->contains(needed) && !(best && best->contains(needed)) ? largest_ : best;
}

// Removes more rows for patches that do not fit, and excludes those that cannot fit or are too large; returns
// false if all fit.
bool RepairPatches::grow_to_fit(RemovedRows& removed, int attempt) const {
    const float radii = std::min(std::pow(kHaste, static_cast<float>(attempt)), kLongestStep);
    bool is_whole = true;
    for (const auto& repair_patch : repair_patches_) {
        const PatchSurface& s = repair_patch->surface;
        const bool is_large = s.group.tube_rows.size() > kMaxOptional && !removed.needs(s.group);
        if (s.is_whole() && !is_large) continue;
        is_whole = false;
        if (s.is_impossible || is_large || attempt >= kMaxAttempts) {
            removed.exclude(s.group);
            continue;
        }
        const std::size_t before = removed.count();
        bool joined = false;
        for (const std::uint32_t cut_ring : s.failed) removed.move_on(s.group.cut_rings[cut_ring], radii);
        for (const TubeRow beyond : s.beyond) {
            if (beyond == kNoIndex) continue;
            removed.mark_around(beyond, radii);
            joined |= removed.join(beyond, s.group.tube_rows[0]);
        }
        if (joined || removed.count() != before) continue;
        // The surface runs into no row, or into one of its own group: extend it at the cut rings instead.
        for (const CutRing& cut_ring : s.group.cut_rings) removed.move_on(cut_ring, radii);
    }
    return !is_whole;
}

bool RepairPatches::can_hold(std::span<const Segment> segments) const {
    return can_march(segments, mesh_, options_);
}

NumberSet put_into(QuadMesh& mesh, const TubeRows& tube_rows, const RemovedRows& removed,
                   const RepairPatches& repair_patches, const Context& ctx) {
    // A vertex is removed with its quads, except for those of the rings.
    NumberSet gone = drop_gone(mesh, tube_rows, removed);
    std::vector<std::vector<std::uint32_t>> rings;
    for (std::size_t i = 0; i < repair_patches.size(); ++i) {
        rings.push_back(ring_vertices(repair_patches[i].surface.group));
        for (const std::uint32_t v : rings.back()) gone.remove(v);
    }
    gone.count();
    drop_vertices(mesh, gone, ctx);
    std::size_t quads = mesh.quads.size(), vertices = mesh.positions.size();
    for (std::size_t i = 0; i < repair_patches.size(); ++i) {
        quads += repair_patches[i].quads.patch.quads.size();
        vertices += repair_patches[i].quads.positions.size();
    }
    mesh.quads.reserve(quads);
    mesh.positions.reserve(vertices);
    for (std::size_t i = 0; i < repair_patches.size(); ++i) {
        const PatchQuads& made = repair_patches[i].quads;
        constexpr std::uint32_t kUnused = 0xffffffffu;
        std::vector<std::uint32_t> place(made.positions.size(), kUnused);
        for (std::size_t k = 0; k < rings[i].size(); ++k) place[k] = rings[i][k] - gone.rank(rings[i][k]);
        for (Quad quad : made.patch.quads) {
            for (std::uint32_t& v : quad) {
                if (place[v] == kUnused) {
                    place[v] = static_cast<std::uint32_t>(mesh.positions.size());
                    mesh.positions.push_back(made.positions[v]);
                }
                v = place[v];
            }
            mesh.quads.push_back(quad);
        }
    }
    return gone;
}

std::uint32_t count_bodies(const TubeRows& tube_rows, const RemovedRows& removed,
                           const RepairPatches& repair_patches) {
    const Skeleton& s = tube_rows.tubes();
    std::size_t members = tube_rows.count();
    for (std::size_t i = 0; i < repair_patches.size(); ++i)
        members += repair_patches[i].quads.positions.size();
    DisjointSets sets(members);
    std::uint32_t count = 0;
    const auto join = [&](std::uint32_t a, std::uint32_t b) { count -= sets.join(a, b) ? 1 : 0; };
    const auto is_kept = [&](TubeRow i) { return i != kNoIndex && !removed.contains(i); };
    for (const NodeId t : nodes(s)) {
        if (s.is_root(t)) {
            count += s.is_tip(t) && is_kept(tube_rows.last(t)) ? 1 : 0;  // a ball
        } else {
            for (TubeRow i = tube_rows.first(t); i <= tube_rows.last(t); ++i) {
                if (!is_kept(i)) continue;
                ++count;
                const TubeRow lower = tube_rows.next(i, false);
                if (is_kept(lower)) join(lower, i);
            }
        }
    }
    for (const NodeId n : nodes(s)) {
        if (!tube_rows.is_fork(n)) continue;
        TubeRow first = kNoIndex;
        tube_rows.for_each_tube_at(n, [&](NodeId t) {
            const TubeRow here = tube_rows.at(t, n);
            if (is_kept(first) && is_kept(here)) join(first, here);
            if (first == kNoIndex) first = here;
        });
    }
    std::uint32_t begin = tube_rows.count();  // first index of the patch's vertices
    for (std::size_t i = 0; i < repair_patches.size(); ++i) {
        const PatchQuads& made = repair_patches[i].quads;
        std::vector<std::uint8_t> is_used(made.positions.size(), 0);
        for (const Quad& q : made.patch.quads) {
            for (const std::uint32_t v : q) {
                count += is_used[v] == 0 ? 1 : 0;
                is_used[v] = 1;
                join(begin + q[0], begin + v);
            }
        }
        std::uint32_t ring = begin;
        for (const CutRing& cut_ring : repair_patches[i].surface.group.cut_rings) {
            join(ring, cut_ring.kept);
            ring += static_cast<std::uint32_t>(cut_ring.ring.size());
        }
        begin += static_cast<std::uint32_t>(made.positions.size());
    }
    return count;
}

}  // namespace coppice::pipeline_internal
