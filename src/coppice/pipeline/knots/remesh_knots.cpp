#include "coppice/pipeline/knots/remesh_knots_internal.h"

#include <algorithm>
#include <iterator>

#include "coppice/mesh/shape.h"
#include "coppice/pipeline/knots/crossings_internal.h"
#include "coppice/pipeline/knots/draft_internal.h"
#include "coppice/pipeline/knots/losses_internal.h"
#include "coppice/skeleton/measure.h"

namespace coppice::pipeline_internal {
namespace {

constexpr int kRoundsForFolds = 3;  // in which seams are moved for the sake of folded quads alone

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

    // From the pairs that cross at first, slices that leave something out, and quads that are folded.
    KnotReport run(const std::vector<FacePair>& first, std::span<const Slice> lossy,
                   std::span<const std::uint32_t> folded) {
        KnotReport report;
        report.pairs_before = first.size();
        for (const FacePair& p : first) {
            const Slice a = slices_.of_quad(p.first), b = slices_.of_quad(p.second);
            knots_.take(a);
            knots_.take(b);
            knots_.join(a, b);
        }
        for (const Slice s : lossy) knots_.take(s);
        report.lossy = static_cast<std::uint32_t>(lossy.size());
        for (const std::uint32_t q : folded) knots_.take(slices_.of_quad(q));
        report.folded = static_cast<std::uint32_t>(folded.size());
        bool has_taken_trees = false;
        for (int round = 0; round < rounds_; ++round) {
            pieces_.make(knots_, care_);
            const Draft now = draft(before_, knots_, pieces_, ctx_);
            const std::vector<FacePair> pairs = new_crossings(now, ctx_);
            // Quads that stay do not cross each other, unless they were spared.
            const std::vector<FacePair> spared = still_there(first);
            report.rounds = static_cast<std::uint32_t>(round) + 1;
            report.pairs_after = pairs.size() + spared.size();
            const bool moved = round < kRoundsForFolds && move_folded_bands();
            if (report.pairs_after == 0 && !moved) break;
            forget_all_but(now, pairs);
            const bool is_answered = answer(now, pairs) || moved;
            if (!is_answered && has_taken_trees) break;
            if (!is_answered || round + 2 >= rounds_) {
                if (!take_trees(now, pairs, spared) && !is_answered) break;
                has_taken_trees = true;
            }
            if (round + 2 >= rounds_) ask_all_care();
        }
        report.slices = static_cast<std::uint32_t>(knots_.count());
        return report;
    }

    // Puts the pieces into the mesh.
    void finish(QuadMesh& mesh, KnotReport& report) const {
        put_into(mesh, slices_, knots_, pieces_, ctx_);
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

    // Asks for more care where a new quad is.
    void take_care(const Draft& now, std::uint32_t face, std::span<const Care> before) {
        const std::size_t at = care_place(now.slice[face]);
        if (before[at] == Care::flat) return;
        care_[at] = before[at] == Care::none ? Care::still : Care::flat;
        pieces_[now.piece[face]].is_current = false;
    }

    // What is done about quads that cross; false when nothing is left to do.
    bool answer(const Draft& now, std::span<const FacePair> pairs) {
        const std::vector<Care> before = care_;
        const std::size_t count = knots_.count();
        bool joined = false;
        for (const FacePair& p : pairs) {
            for (const std::uint32_t face : {p.first, p.second}) {
                if (now.seam[face] != kNoSeam) {
                    knots_.move_on(pieces_[now.piece[face]].surface.group.seams[now.seam[face]], 1);
                } else if (now.piece[face] == Draft::kNoPiece) {
                    knots_.take(now.slice[face]);
                } else if (now.piece[p.first] == now.piece[p.second]) {
                    take_care(now, face, before);
                }
            }
            const Slice a = now.slice[p.first], b = now.slice[p.second];
            if (a != Slices::kNone && b != Slices::kNone) joined |= knots_.join(a, b);
        }
        return joined || knots_.count() != count || care_ != before;
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

    // The last resort: whole trees, where they are not too large for one piece; false when all are.
    bool take_trees(const Draft& now, std::span<const FacePair> pairs, std::span<const FacePair> spared) {
        const std::vector<NodeId> root = tree_roots(slices_.tubes());
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
        std::sort(bad.begin(), bad.end());
        bad.erase(std::unique(bad.begin(), bad.end()), bad.end());
        std::erase_if(bad, [&](NodeId tree) { return !pieces_.can_hold(segments_of(tree, root)); });
        knots_.take_trees(bad, root);
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

    void ask_all_care() {
        std::fill(care_.begin(), care_.end(), Care::flat);
        for (std::size_t i = 0; i < pieces_.size(); ++i) pieces_[i].is_current = false;
    }

    const TubeQuads& before_;
    const Slices& slices_;
    const int rounds_;
    const Context& ctx_;
    Knots knots_;
    Pieces pieces_;
    std::vector<Care> care_;  // per slice, and one more for what is near none
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

KnotReport remesh_knots(QuadSurface& surface, const TubeMap& map, int levels, const MeshOptions& options,
                        const Context& ctx) {
    if (options.remesh_rounds == 0 || options.overlaps == Overlaps::keep || levels == 0 ||
        options.project.method == ProjectionMethod::none || options.control.base == BaseShape::open) {
        return {};
    }
    const Slices slices(surface.cage, map.tubes, levels, map.sides);
    const SliceCrossings found = slice_crossings(surface.mesh, slices, ctx);
    const std::size_t count = found.pairs.size();
    if (count >= kMostPairs) return {.pairs_before = count, .pairs_after = count};
    const std::vector<Slice> lossy = lossy_slices(map, found.tubes, ctx);
    const std::vector<std::uint32_t> folded = folded_quads(surface);
    if (found.pairs.empty() && lossy.empty() && folded.empty()) return {};
    Remeshing remeshing(found.tubes, map, options, ctx);
    KnotReport report = remeshing.run(found.pairs, lossy, folded);
    remeshing.finish(surface.mesh, report);
    return report;
}

}  // namespace coppice::pipeline_internal
