#include "coppice/pipeline/knots/remesh_knots_internal.h"

#include <algorithm>
#include <functional>
#include <iterator>
#include <set>

#include "coppice/base/disjoint_sets.h"
#include "coppice/base/sort.h"
#include "coppice/mesh/shape.h"
#include "coppice/pipeline/knots/crossings_internal.h"
#include "coppice/pipeline/knots/draft_internal.h"
#include "coppice/pipeline/knots/losses_internal.h"
#include "coppice/pipeline/knots/severed_internal.h"
#include "coppice/skeleton/measure.h"

namespace coppice::pipeline_internal {
namespace {

// [radii] Of zones that are taken where nothing else is left to do.
constexpr float kFirstZone = 5;
constexpr float kZoneGrowth = 4;
constexpr float kMaxZone = 100;
constexpr int kLevelsOfSevered = 2;  // from which on severed axes are looked for
constexpr int kRoundsForFolds = 3;   // in which seams are moved for the sake of folded quads alone

class Remeshing {
  public:
    Remeshing(const TubeQuads& before, const TubeMap& map, const MeshOptions& options, const Context& ctx)
        : before_(before),
          slices_(before.slices),
          rounds_(options.remesh_rounds),
          ctx_(ctx),
          knots_(map, slices_, before.mesh, ctx),
          pieces_(map, slices_, before.mesh, options, ctx),
          care_(slices_.count() + 1, Care::none) {}

    // From the pairs that cross at first, slices that leave something out or sever an axis, and quads that
    // are folded.
    KnotReport run(const std::vector<FacePair>& first, std::span<const Slice> lossy,
                   std::span<const Slice> severed, std::span<const std::uint32_t> folded) {
        KnotReport report;
        report.pairs_before = first.size();
        for (const FacePair& p : first) {
            const Slice a = slices_.of_quad(p.first), b = slices_.of_quad(p.second);
            knots_.need(a);
            knots_.need(b);
            knots_.join(a, b);
        }
        for (const Slice s : lossy) knots_.need(s);
        report.lossy = static_cast<std::uint32_t>(lossy.size());
        for (const std::uint32_t q : folded) knots_.need(slices_.of_quad(q));
        report.folded = static_cast<std::uint32_t>(folded.size());
        for (const Slice s : severed) knots_.take(s);
        report.severed = static_cast<std::uint32_t>(severed.size());
        for (int round = 0; round < rounds_; ++round) {
            pieces_.make(knots_, care_);
            const Draft now = draft(before_, knots_, pieces_, ctx_);
            const std::vector<FacePair> pairs = new_crossings(now, ctx_);
            // Quads that stay do not cross each other, unless they were spared.
            const std::vector<FacePair> spared = still_there(first);
            report.rounds = static_cast<std::uint32_t>(round) + 1;
            report.pairs_after = pairs.size() + spared.size();
            if (round + 1 == rounds_) break;  // nothing could be made of what else goes
            const bool moved = round < kRoundsForFolds && move_folded_bands();
            if (report.pairs_after == 0 && !moved) break;
            forget_all_but(now, pairs);
            const bool is_last = round + 2 >= rounds_;
            const std::vector<FacePair> unanswered = answer(now, pairs);
            const bool is_answered = unanswered.size() < pairs.size() || moved;
            const bool took = (!is_last && take_zones(now, unanswered, spared)) ||
                              take_trees(now, is_last ? pairs : unanswered, spared);
            if (!is_answered && !took) break;
            if (is_last) ask_all_care(now, pairs);
        }
        report.slices = static_cast<std::uint32_t>(knots_.count());
        return report;
    }

    // Puts the pieces into the mesh.
    void finish(QuadMesh& mesh, KnotReport& report, RemeshTrace* trace) const {
        NumberSet gone = put_into(mesh, slices_, knots_, pieces_, ctx_);
        if (trace != nullptr) {
            trace->is_local = taken_trees_.empty() && zone_ == kFirstZone && !knots_.spares_any() &&
                              care_.back() == Care::none;
            trace->gone = gone.ascending();
            trace->is_gone.resize(slices_.count());
            for (const Slice s : knots_.taken()) trace->is_gone[s] = 1;
            for (std::size_t i = 0; i < pieces_.size(); ++i) {
                const KnotSurface& made = pieces_[i].surface;
                std::vector<NodeId> segments = made.marched->segments;
                for (const KnotSkeleton::Cut& cut : made.knot.cuts) segments.push_back(cut.segment);
                std::vector<Slice> beside;
                for (const Seam& seam : made.group.seams) beside.push_back(seam.kept);
                trace->pieces.push_back({made.group.slices,
                                         static_cast<std::uint32_t>(pieces_[i].quads.patch.quads.size()),
                                         std::move(beside), std::move(segments)});
            }
        }
        report.parts = count_bodies(slices_, knots_, pieces_);
        // A closed mesh of quads has twice as many edges as quads.
        const auto euler =
            static_cast<std::int64_t>(mesh.positions.size()) - static_cast<std::int64_t>(mesh.quads.size());
        report.handles = static_cast<std::int64_t>(report.parts) - euler / 2;
    }

  private:
    // Those pairs of which both quads stay.
    std::vector<FacePair> still_there(std::span<const FacePair> pairs) const {
        std::vector<FacePair> out;
        const auto stays = [&](std::uint32_t q) { return !knots_.contains(slices_.of_quad(q)); };
        std::copy_if(pairs.begin(), pairs.end(), std::back_inserter(out),
                     [&](const FacePair& p) { return stays(p.first) && stays(p.second); });
        return out;
    }

    // All has been looked at; quads that cross have to be looked at again, changed or not.
    void forget_all_but(const Draft& now, std::span<const FacePair> pairs) {
        for (std::size_t i = 0; i < pieces_.size(); ++i)
            std::ranges::fill(pieces_[i].quads.is_new, std::uint8_t{0});
        for (const FacePair& p : pairs) {
            for (const std::uint32_t face : {p.first, p.second}) {
                if (now.piece[face] != Draft::kNoPiece)
                    pieces_[now.piece[face]].quads.is_new[now.number[face]] = 1;
            }
        }
    }

    std::size_t care_place(Slice s) const { return std::min(s, slices_.count()); }

    // Asks for more care where a new quad is; false when there is no more.
    bool take_care(const Draft& now, std::uint32_t face, std::span<const Care> before) {
        const std::size_t at = care_place(now.slice[face]);
        if (before[at] == Care::flat) return false;
        care_[at] = before[at] == Care::none ? Care::still : Care::flat;
        pieces_[now.piece[face]].is_current = false;
        return true;
    }

    // Does what can be done about quads that cross; returns the pairs in whose group nothing was left to do.
    std::vector<FacePair> answer(const Draft& now, std::span<const FacePair> pairs) {
        const std::vector<Care> before = care_;
        std::vector<FacePair> unanswered;
        std::vector<Slice> answered;
        for (const FacePair& p : pairs) {
            if (!answer(now, p, before)) {
                unanswered.push_back(p);
            } else if (slice_of(now, p) != Slices::kNone) {
                answered.push_back(slice_of(now, p));
            }
        }
        for (Slice& s : answered) s = knots_.group_of(s);
        std::sort(answered.begin(), answered.end());
        std::erase_if(unanswered, [&](const FacePair& p) {
            const Slice s = slice_of(now, p);
            return s != Slices::kNone && std::ranges::binary_search(answered, knots_.group_of(s));
        });
        return unanswered;
    }

    // Where a pair is; none for quads near no slice.
    static Slice slice_of(const Draft& now, const FacePair& p) {
        return now.slice[p.first] != Slices::kNone ? now.slice[p.first] : now.slice[p.second];
    }

    // False when nothing changes by it.
    bool answer(const Draft& now, const FacePair& p, std::span<const Care> before) {
        const std::size_t count = knots_.count();
        bool has_changed = false;
        for (const std::uint32_t face : {p.first, p.second}) {
            if (now.seam[face] != kNoSeam) {
                knots_.move_on(pieces_[now.piece[face]].surface.group.seams[now.seam[face]], 1);
            } else if (now.piece[face] == Draft::kNoPiece) {
                knots_.take(now.slice[face]);
            } else if (now.piece[p.first] == now.piece[p.second]) {
                has_changed |= take_care(now, face, before);
            }
        }
        const Slice a = now.slice[p.first], b = now.slice[p.second];
        if (a != Slices::kNone && b != Slices::kNone) has_changed |= knots_.join(a, b);
        return has_changed || knots_.count() != count;
    }

    // Moves seams on whose bands are folded; false when none is.
    bool move_folded_bands() {
        bool found = false;
        for (std::size_t i = 0; i < pieces_.size(); ++i) {
            const KnotSurface& surface = pieces_[i].surface;
            const KnotQuads& made = pieces_[i].quads;
            for (std::size_t q = 0; q < made.patch.quads.size(); ++q) {
                const std::uint32_t seam = surface.seam[made.patch.triangle[q]];
                if (made.is_new[q] == 0 || seam == kNoSeam ||
                    scaled_jacobian(made.patch.quads[q], made.positions) > 0)
                    continue;
                knots_.move_on(surface.group.seams[seam], 1);
                found = true;
            }
        }
        return found;
    }

    // Where nothing else is left to do: all of the tubes around, and more of them the next times; false where
    // that has been tried.
    bool take_zones(const Draft& now, std::span<const FacePair> pairs, std::span<const FacePair> spared) {
        if (zone_ > kMaxZone || (pairs.empty() && spared.empty())) return false;
        const std::size_t before = knots_.count();
        const auto take = [&](Slice at) {
            if (at != Slices::kNone) knots_.take_zone(at, zone_);
        };
        for (const FacePair& p : pairs) {
            for (const std::uint32_t face : {p.first, p.second}) take(now.slice[face]);
        }
        for (const FacePair& p : spared) {
            for (const std::uint32_t quad : {p.first, p.second}) take(slices_.of_quad(quad));
        }
        zone_ *= kZoneGrowth;
        return knots_.count() != before;
    }

    // The last resort: whole trees, and what is joined to them, where they are not too large for one piece;
    // false when none is new.
    bool take_trees(const Draft& now, std::span<const FacePair> pairs, std::span<const FacePair> spared) {
        if (pairs.empty() && spared.empty()) return false;
        const std::vector<NodeId> root = body_roots(slices_.tubes(), slices_.cage().joins);
        std::vector<NodeId> bad;
        const auto add = [&](Slice at) {
            if (at != Slices::kNone) bad.push_back(root[slices_.tube(at).index()]);
        };
        for (const FacePair& p : pairs) {
            for (const std::uint32_t face : {p.first, p.second}) add(now.slice[face]);
        }
        for (const FacePair& p : spared) {
            for (const std::uint32_t quad : {p.first, p.second}) add(slices_.of_quad(quad));
        }
        sort_unique(bad);
        std::erase_if(bad, [&](NodeId tree) {
            return taken_trees_.contains(tree) || !pieces_.can_hold(segments_of(tree, root));
        });
        knots_.take_trees(bad, root);
        taken_trees_.insert(bad.begin(), bad.end());
        return !bad.empty();
    }

    std::vector<Segment> segments_of(NodeId tree, std::span<const NodeId> root) const {
        const Skeleton& s = slices_.tubes();
        std::vector<Segment> out;
        for (const NodeId n : nodes(s)) {
            if (root[n.index()] == tree && !s.is_root(n)) out.push_back(s.segment(n));
        }
        return out;
    }

    // Asks for all care in the pieces whose quads cross, and in trees that were taken.
    void ask_all_care(const Draft& now, std::span<const FacePair> pairs) {
        const auto ask = [&](std::size_t piece) {
            for (const Slice s : pieces_[piece].surface.group.slices) care_[s] = Care::flat;
            pieces_[piece].is_current = false;
        };
        for (const FacePair& p : pairs) {
            for (const std::uint32_t face : {p.first, p.second}) {
                if (now.piece[face] != Draft::kNoPiece) ask(now.piece[face]);
            }
        }
        care_.back() = Care::flat;
        const std::vector<NodeId> root = body_roots(slices_.tubes(), slices_.cage().joins);
        for (Slice s = 0; s < slices_.count(); ++s) {
            if (taken_trees_.contains(root[slices_.tube(s).index()])) care_[s] = Care::flat;
        }
    }

    const TubeQuads& before_;
    const Slices& slices_;
    const int rounds_;
    const Context& ctx_;
    Knots knots_;
    Pieces pieces_;
    std::vector<Care> care_;  // per slice, and one more for what is near none
    std::set<NodeId> taken_trees_;
    float zone_ = kFirstZone;
};

// Of the quads that could not be unfolded, those that are inverted, ascending.
std::vector<std::uint32_t> folded_quads(const QuadSurface& surface) {
    std::vector<std::uint32_t> out;
    std::ranges::copy_if(surface.untangled.still_bad, std::back_inserter(out), [&](std::uint32_t q) {
        return scaled_jacobian(surface.mesh.quads[q], surface.mesh.positions) <= 0;
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

KnotReport remesh_knots(QuadSurface& surface, const TubeMap& map, int levels, const MeshOptions& options,
                        const Context& ctx, RemeshTrace* trace, std::span<const std::uint8_t> wanted) {
    if (options.remesh_rounds == 0 || options.overlaps == Overlaps::keep || levels == 0 ||
        options.project.method == ProjectionMethod::none || options.control.base == BaseShape::open) {
        return {};
    }
    const Slices slices(surface.cage, map.tubes, levels, map.sides);
    SliceCrossings found = slice_crossings(surface.mesh, slices, ctx);
    const std::size_t count = found.pairs.size();
    if (count >= kMostPairs) return {.pairs_before = count, .pairs_after = count};
    std::vector<Slice> lossy = lossy_slices(map, found.tubes, ctx);
    // What enters another branch is cut off there on purpose unless both are to be one body. Coarse surfaces
    // keep their number of faces, and those of other methods their own joints.
    std::vector<Slice> severed;
    if (options.method == MeshMethod::quads && options.overlaps == Overlaps::merge &&
        levels >= kLevelsOfSevered)
        severed = severed_slices(map, found.tubes, ctx);
    std::vector<std::uint32_t> folded = folded_quads(surface);
    if (!wanted.empty()) {
        const auto is_wanted = [&](Slice s) { return wanted[slices.tube(s).index()] != 0; };
        const auto has_wanted = [&](std::uint32_t quad) { return is_wanted(slices.of_quad(quad)); };
        std::erase_if(found.pairs,
                      [&](const FacePair& p) { return !has_wanted(p.first) && !has_wanted(p.second); });
        std::erase_if(lossy, std::not_fn(is_wanted));
        std::erase_if(severed, std::not_fn(is_wanted));
        std::erase_if(folded, std::not_fn(has_wanted));
    }
    if (found.pairs.empty() && lossy.empty() && severed.empty() && folded.empty()) return {};
    Remeshing remeshing(found.tubes, map, options, ctx);
    KnotReport report = remeshing.run(found.pairs, lossy, severed, folded);
    remeshing.finish(surface.mesh, report, trace);
    return report;
}

}  // namespace coppice::pipeline_internal
