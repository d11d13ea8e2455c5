#include "coppice/pipeline/knots/remesh_knots_internal.h"

#include <algorithm>
#include <cmath>
#include <memory>
#include <unordered_map>

#include "coppice/base/parallel.h"
#include "coppice/mesh/shape.h"
#include "coppice/mesh/topology.h"
#include "coppice/pipeline/knots/crossings_internal.h"
#include "coppice/pipeline/knots/knot_patch_internal.h"
#include "coppice/pipeline/knots/losses_internal.h"
#include "coppice/skeleton/measure.h"

namespace coppice::pipeline_internal {
namespace {

constexpr int kMostAttempts = 10;
constexpr float kLongestStep = 6;   // [radii]
constexpr float kHaste = 1.5f;      // growth of the steps by which groups grow, from one radius on
constexpr int kRoundsForFolds = 3;  // in which seams are moved for the sake of folded quads alone

// What stands in the place of one group.
struct Piece {
    KnotSurface surface;
    KnotQuads quads;
    bool is_current = false;  // whether `quads` are as careful as asked
};

// Quads of the whole mesh, those that stay first.
struct Remeshed {
    QuadMesh mesh;
    std::vector<Slice> slice;          // per quad: where it is, or none
    std::vector<std::uint32_t> piece;  // per quad: the piece it is of, or none
    std::vector<std::uint32_t> seam;   // per quad: of whose band it is, or kNoSeam
    std::uint32_t kept = 0;            // quads that stay
};

// A piece of the skeleton has no points of its own to fit global weights to.
MeshOptions with_local_weights(MeshOptions options) {
    options.field.weights = Weights::local;
    return options;
}

class Remeshing {
  public:
    Remeshing(const QuadSurface& surface, const TubeMap& map, const Slices& slices,
              const MeshOptions& options, const Context& ctx)
        : quads_(surface.mesh),
          options_(with_local_weights(options)),
          ctx_(ctx),
          slices_(slices),
          knots_(map, slices, surface.mesh, ctx),
          skeletons_(map, slices),
          care_(slices.count() + 1, Care::none) {}

    // From the pairs that cross at first, and slices that leave something out.
    KnotReport run(std::vector<FacePair> pairs, std::span<const Slice> lossy, QuadSurface& surface) {
        KnotReport report;
        report.pairs_before = pairs.size();
        for (const FacePair& p : pairs) {
            const Slice a = slices_.of_quad(p.first), b = slices_.of_quad(p.second);
            knots_.take(a);
            knots_.take(b);
            knots_.join(a, b);
        }
        for (const Slice s : lossy) knots_.take(s);
        report.lossy = static_cast<std::uint32_t>(lossy.size());
        const int rounds = options_.remesh_rounds;
        Remeshed now;
        bool has_taken_trees = false;
        for (int round = 0; round < rounds; ++round) {
            make_pieces();
            now = assembled();
            // Quads that stay do not cross each other, unless they were spared: those that did are gone.
            pairs = new_crossings(now.mesh, knots_.spares_any() ? 0 : now.kept, ctx_);
            report.rounds = static_cast<std::uint32_t>(round) + 1;
            const bool moved = round < kRoundsForFolds && move_folded_bands(now);
            if (pairs.empty() && !moved) break;
            const bool is_answered = answer(now, pairs) || moved;
            if (!is_answered && has_taken_trees) break;
            if (!is_answered || round + 2 >= rounds) {
                take_trees(now, pairs);
                has_taken_trees = true;
            }
            if (round + 2 >= rounds) ask_all_care();
        }
        report.pairs_after = pairs.size();
        report.slices = knots_.count();
        const TopologyReport found = topology(now.mesh, ctx_);
        report.parts = found.components;
        report.handles = static_cast<std::int64_t>(found.components) - found.euler / 2;
        surface.mesh = std::move(now.mesh);
        return report;
    }

  private:
    std::size_t care_place(Slice s) const { return std::min(s, slices_.count()); }

    // Asks for more care where a new quad is.
    void take_care(const Remeshed& now, std::uint32_t face, std::span<const Care> before) {
        const std::size_t at = care_place(now.slice[face]);
        if (before[at] == Care::flat) return;
        care_[at] = before[at] == Care::none ? Care::still : Care::flat;
        pieces_[now.piece[face]]->is_current = false;
    }

    // What is done about quads that cross; false when nothing is left to do.
    bool answer(const Remeshed& now, std::span<const FacePair> pairs) {
        const std::vector<Care> before = care_;
        const std::uint32_t count = knots_.count();
        bool joined = false;
        for (const FacePair& p : pairs) {
            for (const std::uint32_t face : {p.first, p.second}) {
                if (now.seam[face] != kNoSeam) {
                    knots_.move_on(pieces_[now.piece[face]]->surface.group.seams[now.seam[face]], 1);
                } else if (face < now.kept) {
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
    bool move_folded_bands(const Remeshed& now) {
        bool found = false;
        for (auto face = now.kept; face < now.mesh.quads.size(); ++face) {
            if (now.seam[face] == kNoSeam || scaled_jacobian(now.mesh.quads[face], now.mesh.positions) > 0)
                continue;
            knots_.move_on(pieces_[now.piece[face]]->surface.group.seams[now.seam[face]], 1);
            found = true;
        }
        return found;
    }

    // The last resort: whole trees.
    void take_trees(const Remeshed& now, std::span<const FacePair> pairs) {
        const std::vector<NodeId> root = tree_roots(slices_.tubes());
        std::vector<NodeId> bad;
        for (const FacePair& p : pairs) {
            for (const std::uint32_t face : {p.first, p.second}) {
                const Slice at = now.slice[face];
                if (at != Slices::kNone) bad.push_back(root[slices_.tube(at).index()]);
            }
        }
        std::sort(bad.begin(), bad.end());
        bad.erase(std::unique(bad.begin(), bad.end()), bad.end());
        knots_.take_trees(bad, root);
    }

    void ask_all_care() {
        std::fill(care_.begin(), care_.end(), Care::flat);
        for (const auto& piece : pieces_) piece->is_current = false;
    }

    // Pieces for all groups; groups grow until each has one that fits.
    void make_pieces() {
        for (int attempt = 0;; ++attempt) {
            ctx_.throw_if_cancelled();
            knots_.close();
            std::vector<KnotGroup> groups = knots_.groups();
            std::vector<std::unique_ptr<Piece>> pieces(groups.size());
            for (std::size_t g = 0; g < groups.size(); ++g) {
                const auto same = made_.find(groups[g].slices[0]);
                if (same != made_.end() && pieces_[same->second]->surface.group.slices == groups[g].slices)
                    pieces[g] = std::move(pieces_[same->second]);
            }
            parallel_for(ctx_, groups.size(), 1, [&](std::size_t g) {
                if (pieces[g]) return;
                pieces[g] = std::make_unique<Piece>(Piece{
                    knot_surface(std::move(groups[g]), skeletons_, quads_, options_, inner_context()), {}});
            });
            pieces_ = std::move(pieces);
            made_.clear();
            for (std::uint32_t i = 0; i < pieces_.size(); ++i) made_[pieces_[i]->surface.group.slices[0]] = i;
            bool is_whole = true;
            const float radii = std::min(std::pow(kHaste, static_cast<float>(attempt)), kLongestStep);
            for (const auto& piece : pieces_) {
                const KnotSurface& s = piece->surface;
                is_whole &= s.is_whole();
                if (s.is_impossible || (attempt >= kMostAttempts && !s.is_whole())) {
                    knots_.spare(s.group);
                    continue;
                }
                for (const std::uint32_t seam : s.failed) knots_.move_on(s.group.seams[seam], radii);
                for (const Slice beyond : s.beyond) {
                    if (beyond == Slices::kNone) continue;
                    knots_.take_around(beyond, radii);
                    knots_.join(beyond, s.group.slices[0]);
                }
            }
            if (is_whole) break;
        }
        parallel_for(ctx_, pieces_.size(), 1, [&](std::size_t i) {
            Piece& p = *pieces_[i];
            if (p.is_current) return;
            p.quads = knot_quads(p.surface, care_, options_, inner_context());
            p.is_current = true;
        });
    }

    // Pieces are made side by side, each by one thread.
    Context inner_context() const { return {.threads = 1, .stop = ctx_.stop}; }

    Remeshed assembled() const {
        Remeshed out;
        out.mesh.origin = quads_.origin;
        constexpr std::uint32_t kUnused = 0xffffffffu;
        std::vector<std::uint32_t> place(quads_.positions.size(), kUnused);
        const auto put = [&](std::uint32_t& at, Vec3 p) {
            if (at == kUnused) {
                at = static_cast<std::uint32_t>(out.mesh.positions.size());
                out.mesh.positions.push_back(p);
            }
            return at;
        };
        for (std::uint32_t q = 0; q < quads_.quads.size(); ++q) {
            const Slice s = slices_.of_quad(q);
            if (knots_.contains(s)) continue;
            Quad quad = quads_.quads[q];
            for (std::uint32_t& v : quad) v = put(place[v], quads_.positions[v]);
            out.mesh.quads.push_back(quad);
            out.slice.push_back(s);
        }
        out.kept = static_cast<std::uint32_t>(out.mesh.quads.size());
        out.piece.assign(out.kept, kUnused);
        out.seam.assign(out.kept, kNoSeam);
        for (std::uint32_t i = 0; i < pieces_.size(); ++i) {
            const auto& [surface, made, _] = *pieces_[i];
            std::vector<std::uint32_t> own(made.positions.size(), kUnused);
            std::uint32_t k = 0;
            for (const Seam& seam : surface.group.seams) {
                for (const std::uint32_t v : seam.ring) own[k++] = place[v];
            }
            for (std::size_t q = 0; q < made.quads.size(); ++q) {
                Quad quad = made.quads[q];
                for (std::uint32_t& v : quad) v = put(own[v], made.positions[v]);
                out.mesh.quads.push_back(quad);
                const std::uint32_t t = made.triangle[q];
                out.slice.push_back(surface.slice[t]);
                out.piece.push_back(i);
                out.seam.push_back(surface.seam[t]);
            }
        }
        return out;
    }

    const QuadMesh& quads_;
    const MeshOptions options_;
    const Context& ctx_;
    const Slices& slices_;
    Knots knots_;
    KnotSkeletons skeletons_;
    std::vector<Care> care_;  // per slice, and one more for what is near none
    std::vector<std::unique_ptr<Piece>> pieces_;
    std::unordered_map<Slice, std::uint32_t> made_;  // by the least slice of each
};

// The tubes by node of the field's skeleton, less those that are only a branch node at a root.
std::vector<NodeId> real_tubes(const TubeMap& map) {
    std::vector<NodeId> out(map.tube.begin(), map.tube.end());
    for (NodeId& t : out) {
        if (t && map.tubes.is_root(t) && !map.tubes.is_tip(t)) t = NodeId::none();
    }
    return out;
}

}  // namespace

KnotReport remesh_knots(QuadSurface& surface, const TubeMap& map, const MeshOptions& options,
                        const Context& ctx) {
    if (options.remesh_rounds == 0 || options.overlaps == Overlaps::keep || options.levels == 0 ||
        options.project.method == ProjectionMethod::none || options.control.base == BaseShape::open) {
        return {};
    }
    const std::vector<NodeId> wrapping = real_tubes(map);
    const TubeMap real{map.tubes, map.skeleton, map.source, wrapping};
    const Slices slices(surface.cage, map.tubes, options.levels);
    std::vector<FacePair> pairs = slice_crossings(surface.mesh, slices, ctx);
    if (pairs.size() >= kMostPairs) return {.pairs_before = pairs.size(), .pairs_after = pairs.size()};
    const std::vector<Slice> lossy = lossy_slices(real, slices, surface.mesh, ctx);
    if (pairs.empty() && lossy.empty()) return {};
    return Remeshing(surface, real, slices, options, ctx).run(std::move(pairs), lossy, surface);
}

}  // namespace coppice::pipeline_internal
