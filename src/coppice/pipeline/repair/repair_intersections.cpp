#include "coppice/pipeline/repair/repair_intersections_internal.h"

#include <algorithm>
#include <functional>
#include <iterator>
#include <set>

#include "coppice/base/disjoint_sets.h"
#include "coppice/base/id.h"
#include "coppice/base/sort.h"
#include "coppice/mesh/shape.h"
#include "coppice/pipeline/repair/candidate_internal.h"
#include "coppice/pipeline/repair/crossings_internal.h"
#include "coppice/pipeline/repair/losses_internal.h"
#include "coppice/pipeline/repair/severed_internal.h"
#include "coppice/skeleton/measure.h"
#include "coppice/skeleton/segment_cone.h"

namespace coppice::pipeline_internal {
namespace {

// [radii] Size of the zones that are removed if all other repairs failed.
constexpr float kFirstZone = 5;
constexpr float kZoneGrowth = 4;
constexpr float kMaxZone = 100;
constexpr int kRoundsForFolds = 3;  // rounds in which cut rings are moved for folded quads alone

// Returns the branches that end in a hidden tip.
std::vector<RoundCone> hidden_branches(const QuadBuild& build) {
    std::vector<RoundCone> out;
    for (const NodeId n : nodes(build.skeleton)) {
        if (is_hidden_tip(n, build) && !build.skeleton.is_root(n))
            out.push_back(round_cone<double>(build.skeleton.segment(n)));
    }
    return out;
}

class Remeshing {
  public:
    Remeshing(const TubeQuads& before, const QuadBuild& build, const Context& ctx)
        : before_(before),
          tube_rows_(before.tube_rows),
          rounds_(build.options.remesh_rounds),
          ctx_(ctx),
          removed_(tube_rows_, before.mesh, hidden_branches(build), ctx),
          repair_patches_(build, tube_rows_, before.mesh, ctx),
          repair_level_(tube_rows_.count() + 1, RepairLevel::none) {}

    // Repairs the initially intersecting pairs, rows that leave something out or sever an axis, and folded
    // quads.
    RemeshReport run(const std::vector<FacePair>& first, std::span<const TubeRow> lossy,
                     std::span<const TubeRow> severed, std::span<const std::uint32_t> folded) {
        RemeshReport report;
        report.pairs_before = first.size();
        for (const FacePair& p : first) {
            const TubeRow a = tube_rows_.of_quad(p.first), b = tube_rows_.of_quad(p.second);
            removed_.require(a);
            removed_.require(b);
            removed_.join(a, b);
        }
        for (const TubeRow s : lossy) removed_.require(s);
        report.lost_bulges = static_cast<std::uint32_t>(lossy.size());
        for (const std::uint32_t q : folded) removed_.require(tube_rows_.of_quad(q));
        report.folded = static_cast<std::uint32_t>(folded.size());
        for (const TubeRow s : severed) removed_.mark_removed(s);
        report.severed = static_cast<std::uint32_t>(severed.size());
        for (int round = 0; round < rounds_; ++round) {
            repair_patches_.make(removed_, repair_level_);
            const CandidateQuads now = candidate(before_, removed_, repair_patches_, ctx_);
            const std::vector<FacePair> pairs = new_crossings(now, ctx_);
            // Kept quads do not intersect each other, unless they were excluded.
            const std::vector<FacePair> spared = still_there(first);
            report.rounds = static_cast<std::uint32_t>(round) + 1;
            report.pairs_after = pairs.size() + spared.size();
            if (round + 1 == rounds_) break;  // rows removed now could not be replaced
            const bool moved = round < kRoundsForFolds && move_folded_bands();
            if (report.pairs_after == 0 && !moved) break;
            forget_all_but(now, pairs);
            const bool is_last = round + 2 >= rounds_;
            const std::vector<FacePair> unanswered = answer(now, pairs);
            const bool is_answered = unanswered.size() < pairs.size() || moved;
            const bool took = (!is_last && take_zones(now, unanswered, spared)) ||
                              mark_trees(now, is_last ? pairs : unanswered, spared);
            if (!is_answered && !took) break;
            if (is_last) ask_all_care(now, pairs);
        }
        report.tube_rows = static_cast<std::uint32_t>(removed_.count());
        return report;
    }

    // Inserts the repair patches into the mesh, and completes the report.
    RemeshTrace finish(QuadMesh& mesh, RemeshReport& report) const {
        RemeshTrace trace;
        trace.is_local = taken_trees_.empty() && zone_ == kFirstZone && !removed_.has_excluded() &&
                         repair_level_.back() == RepairLevel::none;
        trace.gone = put_into(mesh, tube_rows_, removed_, repair_patches_, ctx_).ascending();
        trace.is_gone.resize(tube_rows_.count());
        for (const TubeRow s : removed_.marked()) trace.is_gone[s] = 1;
        for (std::size_t i = 0; i < repair_patches_.size(); ++i)
            trace.repair_patches.push_back(make_trace(repair_patches_[i]));
        report.parts = count_bodies(tube_rows_, removed_, repair_patches_);
        // A closed mesh of quads has twice as many edges as quads.
        const auto euler =
            static_cast<std::int64_t>(mesh.positions.size()) - static_cast<std::int64_t>(mesh.quads.size());
        report.handles = static_cast<std::int64_t>(report.parts) - euler / 2;
        return trace;
    }

  private:
    static RemeshTrace::RepairPatch make_trace(const RepairPatch& repair_patch) {
        const PatchSurface& made = repair_patch.surface;
        RemeshTrace::RepairPatch out{
            .tube_rows = made.group.tube_rows, .adjacent = {}, .segments = made.marched->segments};
        out.quads = static_cast<std::uint32_t>(repair_patch.quads.patch.quads.size());
        for (const CutRing& cut_ring : made.group.cut_rings) out.adjacent.push_back(cut_ring.kept);
        for (const PatchSkeleton::Cut& cut : made.patch_skeleton.cuts) out.segments.push_back(cut.segment);
        return out;
    }

    // Returns the pairs of which both quads are kept.
    std::vector<FacePair> still_there(std::span<const FacePair> pairs) const {
        std::vector<FacePair> out;
        const auto stays = [&](std::uint32_t q) { return !removed_.contains(tube_rows_.of_quad(q)); };
        std::copy_if(pairs.begin(), pairs.end(), std::back_inserter(out),
                     [&](const FacePair& p) { return stays(p.first) && stays(p.second); });
        return out;
    }

    // Marks all quads as checked, except those of intersecting pairs, which have to be checked again, changed
    // or not.
    void forget_all_but(const CandidateQuads& now, std::span<const FacePair> pairs) {
        for (std::size_t i = 0; i < repair_patches_.size(); ++i)
            std::ranges::fill(repair_patches_[i].quads.is_new, std::uint8_t{0});
        for (const FacePair& p : pairs) {
            for (const std::uint32_t face : {p.first, p.second}) {
                if (now.repair_patch[face] != kNoIndex)
                    repair_patches_[now.repair_patch[face]].quads.is_new[now.number[face]] = 1;
            }
        }
    }

    std::size_t care_place(TubeRow s) const { return std::min(s, tube_rows_.count()); }

    // Raises the repair level at a new quad; returns false at the maximum level.
    bool raise_repair_level(const CandidateQuads& now, std::uint32_t face,
                            std::span<const RepairLevel> before) {
        const std::size_t at = care_place(now.tube_row[face]);
        if (before[at] == RepairLevel::flat) return false;
        repair_level_[at] = before[at] == RepairLevel::none ? RepairLevel::still : RepairLevel::flat;
        repair_patches_[now.repair_patch[face]].is_current = false;
        return true;
    }

    // Applies the possible repairs to intersecting quads; returns the pairs in groups without any repair
    // left.
    std::vector<FacePair> answer(const CandidateQuads& now, std::span<const FacePair> pairs) {
        const std::vector<RepairLevel> before = repair_level_;
        std::vector<FacePair> unanswered;
        std::vector<TubeRow> answered;
        for (const FacePair& p : pairs) {
            if (!answer(now, p, before)) {
                unanswered.push_back(p);
            } else if (find_row(now, p) != kNoIndex) {
                answered.push_back(find_row(now, p));
            }
        }
        for (TubeRow& s : answered) s = removed_.find_group(s);
        std::sort(answered.begin(), answered.end());
        std::erase_if(unanswered, [&](const FacePair& p) {
            const TubeRow s = find_row(now, p);
            return s != kNoIndex && std::ranges::binary_search(answered, removed_.find_group(s));
        });
        return unanswered;
    }

    // Returns the row of a pair; none for quads without a close row.
    static TubeRow find_row(const CandidateQuads& now, const FacePair& p) {
        return now.tube_row[p.first] != kNoIndex ? now.tube_row[p.first] : now.tube_row[p.second];
    }

    // Returns false if it changes nothing.
    bool answer(const CandidateQuads& now, const FacePair& p, std::span<const RepairLevel> before) {
        const std::size_t count = removed_.count();
        bool has_changed = false;
        for (const std::uint32_t face : {p.first, p.second}) {
            if (now.cut_ring[face] != kNoIndex) {
                removed_.move_on(
                    repair_patches_[now.repair_patch[face]].surface.group.cut_rings[now.cut_ring[face]], 1);
            } else if (now.repair_patch[face] == kNoIndex) {
                removed_.mark_removed(now.tube_row[face]);
            } else if (now.repair_patch[p.first] == now.repair_patch[p.second]) {
                has_changed |= raise_repair_level(now, face, before);
            }
        }
        const TubeRow a = now.tube_row[p.first], b = now.tube_row[p.second];
        if (a != kNoIndex && b != kNoIndex) has_changed |= removed_.join(a, b);
        return has_changed || removed_.count() != count;
    }

    // Moves cut rings with folded bands; returns false if there are none.
    bool move_folded_bands() {
        bool found = false;
        for (std::size_t i = 0; i < repair_patches_.size(); ++i) {
            const PatchSurface& surface = repair_patches_[i].surface;
            const PatchQuads& made = repair_patches_[i].quads;
            for (std::size_t q = 0; q < made.patch.quads.size(); ++q) {
                const std::uint32_t cut_ring = surface.cut_ring[made.patch.triangle[q]];
                if (made.is_new[q] == 0 || cut_ring == kNoIndex ||
                    scaled_jacobian(made.patch.quads[q], made.positions) > 0)
                    continue;
                removed_.move_on(surface.group.cut_rings[cut_ring], 1);
                found = true;
            }
        }
        return found;
    }

    // Removes all tubes around as the second to last resort, in growing zones; returns false if that has been
    // tried.
    bool take_zones(const CandidateQuads& now, std::span<const FacePair> pairs,
                    std::span<const FacePair> spared) {
        if (zone_ > kMaxZone || (pairs.empty() && spared.empty())) return false;
        const std::size_t before = removed_.count();
        const auto mark_zone = [&](TubeRow at) {
            if (at != kNoIndex) removed_.mark_zone(at, zone_);
        };
        for (const FacePair& p : pairs) {
            for (const std::uint32_t face : {p.first, p.second}) mark_zone(now.tube_row[face]);
        }
        for (const FacePair& p : spared) {
            for (const std::uint32_t quad : {p.first, p.second}) mark_zone(tube_rows_.of_quad(quad));
        }
        zone_ *= kZoneGrowth;
        return removed_.count() != before;
    }

    // The last resort: removes whole trees, with all that is joined to them, unless they are too large for
    // one patch; returns false if there is no new tree.
    bool mark_trees(const CandidateQuads& now, std::span<const FacePair> pairs,
                    std::span<const FacePair> spared) {
        if (pairs.empty() && spared.empty()) return false;
        const std::vector<NodeId> root = body_roots(tube_rows_.tubes(), tube_rows_.cage().joins);
        std::vector<NodeId> bad;
        const auto add = [&](TubeRow at) {
            if (at != kNoIndex) bad.push_back(root[tube_rows_.tube(at).index()]);
        };
        for (const FacePair& p : pairs) {
            for (const std::uint32_t face : {p.first, p.second}) add(now.tube_row[face]);
        }
        for (const FacePair& p : spared) {
            for (const std::uint32_t quad : {p.first, p.second}) add(tube_rows_.of_quad(quad));
        }
        sort_unique(bad);
        std::erase_if(bad, [&](NodeId tree) {
            return taken_trees_.contains(tree) || !repair_patches_.can_hold(collect_segments(tree, root));
        });
        removed_.mark_trees(bad, root);
        taken_trees_.insert(bad.begin(), bad.end());
        return !bad.empty();
    }

    std::vector<Segment> collect_segments(NodeId tree, std::span<const NodeId> root) const {
        const Skeleton& s = tube_rows_.tubes();
        std::vector<Segment> out;
        for (const NodeId n : nodes(s)) {
            if (root[n.index()] == tree && !s.is_root(n)) out.push_back(s.segment(n));
        }
        return out;
    }

    // Sets the maximum repair level in the patches with intersecting quads, and in trees that were removed.
    void ask_all_care(const CandidateQuads& now, std::span<const FacePair> pairs) {
        const auto ask = [&](std::size_t repair_patch) {
            for (const TubeRow s : repair_patches_[repair_patch].surface.group.tube_rows)
                repair_level_[s] = RepairLevel::flat;
            repair_patches_[repair_patch].is_current = false;
        };
        for (const FacePair& p : pairs) {
            for (const std::uint32_t face : {p.first, p.second}) {
                if (now.repair_patch[face] != kNoIndex) ask(now.repair_patch[face]);
            }
        }
        repair_level_.back() = RepairLevel::flat;
        const std::vector<NodeId> root = body_roots(tube_rows_.tubes(), tube_rows_.cage().joins);
        for (TubeRow s = 0; s < tube_rows_.count(); ++s) {
            if (taken_trees_.contains(root[tube_rows_.tube(s).index()])) repair_level_[s] = RepairLevel::flat;
        }
    }

    const TubeQuads& before_;
    const TubeRows& tube_rows_;
    const int rounds_;
    const Context& ctx_;
    RemovedRows removed_;
    RepairPatches repair_patches_;
    std::vector<RepairLevel> repair_level_;  // per row, and one more for triangles without a close row
    std::set<NodeId> taken_trees_;
    float zone_ = kFirstZone;
};

// Returns the quads that could not be unfolded and are inverted, ascending.
std::vector<std::uint32_t> folded_quads(const QuadMesh& mesh, const UntangleReport& untangled) {
    std::vector<std::uint32_t> out;
    std::ranges::copy_if(untangled.still_bad, std::back_inserter(out), [&](std::uint32_t q) {
        return scaled_jacobian(mesh.quads[q], mesh.positions) <= 0;
    });
    return out;
}

}  // namespace

std::vector<NodeId> body_roots(const Skeleton& tubes, std::span<const NodeJoin> joins) {
    std::vector<NodeId> root = tree_roots(tubes);
    DisjointSets bodies(root.size());
    for (const NodeJoin& join : joins)
        bodies.join(root[join.end.index()].index(), root[join.node.index()].index());
    for (NodeId& n : root) n = NodeId(bodies.find(n.index()));
    return root;
}

RemeshResult repair_intersections(QuadMesh& mesh, const UntangleReport& untangled, const QuadBuild& build,
                                  std::span<const std::uint8_t> wanted, const Context& ctx) {
    const MeshOptions& options = build.options;
    const int levels = build.refinement.levels();
    if (options.remesh_rounds == 0 || options.overlaps == Overlaps::keep || levels == 0 ||
        options.project.method == ProjectionMethod::none || options.control.base == BaseShape::open) {
        return {};
    }
    const TubeRows tube_rows(build.cage, build.tubes, levels, build.sides);
    TubeCrossings found = find_tube_crossings(mesh, tube_rows, ctx);
    const std::size_t count = found.pairs.size();
    if (count >= kMaxPairs)
        return {.report = {.is_searched = true, .pairs_before = count, .pairs_after = count}, .trace = {}};
    std::vector<TubeRow> lossy = find_lossy_rows(build, found.tubes, ctx);
    // A section that enters another branch is cut off on purpose unless both become one body. Surfaces of
    // other methods keep their own joints.
    std::vector<TubeRow> severed;
    if (options.method == MeshMethod::quads && options.overlaps == Overlaps::merge)
        severed = find_severed_rows(build, found.tubes, ctx);
    std::vector<std::uint32_t> folded = folded_quads(mesh, untangled);
    if (!wanted.empty()) {
        const auto is_wanted = [&](TubeRow s) { return wanted[tube_rows.tube(s).index()] != 0; };
        const auto has_wanted = [&](std::uint32_t quad) { return is_wanted(tube_rows.of_quad(quad)); };
        std::erase_if(found.pairs,
                      [&](const FacePair& p) { return !has_wanted(p.first) && !has_wanted(p.second); });
        std::erase_if(lossy, std::not_fn(is_wanted));
        std::erase_if(severed, std::not_fn(is_wanted));
        std::erase_if(folded, std::not_fn(has_wanted));
    }
    RemeshResult out;
    if (!found.pairs.empty() || !lossy.empty() || !severed.empty() || !folded.empty()) {
        Remeshing remeshing(found.tubes, build, ctx);
        out.report = remeshing.run(found.pairs, lossy, severed, folded);
        out.trace = remeshing.finish(mesh, out.report);
    }
    out.report.is_searched = wanted.empty();
    return out;
}

}  // namespace coppice::pipeline_internal
