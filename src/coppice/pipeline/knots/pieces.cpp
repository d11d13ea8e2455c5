#include "coppice/pipeline/knots/pieces_internal.h"

#include <algorithm>
#include <cmath>

#include "coppice/base/parallel.h"

namespace coppice::pipeline_internal {
namespace {

constexpr std::size_t kMaxOptional = 64;  // slices of a piece that is made for severed axes alone
constexpr int kMostAttempts = 30;
constexpr float kLongestStep = 6;  // [radii]
constexpr float kHaste = 1.5f;     // growth of the steps by which groups grow, from one radius on
constexpr std::size_t kQuadGrain = 4096;
constexpr std::size_t kLarge = 400;  // slices of a piece that is worth all threads

// A piece of the skeleton has no points of its own to fit global weights to.
MeshOptions with_local_weights(MeshOptions options) {
    options.field.weights = Weights::local;
    return options;
}

// Calls make(i, ctx) for some groups.
template <class GroupOf, class Make>
void make_each(std::span<const std::uint32_t> which, const GroupOf& group, const Context& ctx,
               const Make& make) {
    const auto is_large = [&](std::size_t k) { return group(which[k]).slices.size() >= kLarge; };
    parallel_for_uneven(ctx, which.size(), 1, is_large,
                        [&](std::size_t k, const Context& c) { make(which[k], c); });
}

// Drops the quads of slices that go; returns their vertices.
NumberSet drop_gone(QuadMesh& mesh, const Slices& slices, const Knots& knots) {
    std::vector<std::uint8_t> is_touched(slices.tubes().size(), 0);
    for (const Slice s : knots.taken()) is_touched[slices.tube(s).index()] = 1;
    NumberSet gone(mesh.positions.size());
    std::size_t kept = 0;
    const std::uint32_t per_face = 1u << (2 * slices.levels());
    const auto count = static_cast<std::uint32_t>(slices.cage().region.size());
    for (std::uint32_t f = 0, q = 0; f < count; ++f) {
        if (is_touched[slices.tube_of(f).index()] == 0) {
            std::copy_n(mesh.quads.begin() + q, per_face,
                        mesh.quads.begin() + static_cast<std::ptrdiff_t>(kept));
            kept += per_face;
            q += per_face;
            continue;
        }
        for (const std::uint32_t end = q + per_face; q < end; ++q) {
            if (knots.contains(slices.of_quad(q))) {
                for (const std::uint32_t v : mesh.quads[q]) gone.add(v);
            } else {
                mesh.quads[kept++] = mesh.quads[q];
            }
        }
    }
    mesh.quads.resize(kept);
    return gone;
}

// Drops some vertices and numbers the others anew.
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

Pieces::Pieces(const TubeMap& map, const Slices& slices, const QuadMesh& mesh, const MeshOptions& options,
               const Context& ctx)
    : mesh_(mesh),
      options_(with_local_weights(options)),
      ctx_(ctx),
      skeletons_(map, slices),
      owner_(slices.count(), kNobody) {}

void Pieces::make(Knots& knots, std::span<const Care> care) {
    for (int attempt = 0;; ++attempt) {
        ctx_.throw_if_cancelled();
        knots.close();
        follow(knots.groups());
        if (!grow_to_fit(knots, attempt)) break;
    }
    std::vector<std::uint32_t> stale;
    for (std::uint32_t i = 0; i < pieces_.size(); ++i) {
        if (!pieces_[i]->is_current) stale.push_back(i);
    }
    const auto group_of = [&](std::uint32_t i) -> const KnotGroup& { return pieces_[i]->surface.group; };
    make_each(stale, group_of, ctx_, [&](std::uint32_t i, const Context& ctx) {
        Piece& p = *pieces_[i];
        make_quads(p.quads, p.surface, care, options_, ctx);
        p.is_current = true;
    });
}

// Pieces for these groups; those that stayed the same keep theirs.
void Pieces::follow(std::vector<KnotGroup> groups) {
    std::vector<std::unique_ptr<Piece>> pieces(groups.size());
    std::vector<std::uint32_t> changed;
    for (std::uint32_t g = 0; g < groups.size(); ++g) {
        const std::uint32_t before = owner_[groups[g].slices[0]];
        if (before != kNobody && pieces_[before] &&
            pieces_[before]->surface.group.slices == groups[g].slices) {
            pieces[g] = std::move(pieces_[before]);
            continue;
        }
        changed.push_back(g);
    }
    const auto group_of = [&](std::uint32_t g) -> const KnotGroup& { return groups[g]; };
    make_each(changed, group_of, ctx_, [&](std::uint32_t g, const Context& ctx) {
        auto made = made_for(groups[g]);
        pieces[g] = std::make_unique<Piece>(
            Piece{knot_surface(std::move(groups[g]), std::move(made), skeletons_, mesh_, options_, ctx), {}});
    });
    pieces_ = std::move(pieces);
    std::fill(owner_.begin(), owner_.end(), kNobody);
    for (std::uint32_t i = 0; i < pieces_.size(); ++i) {
        for (const Slice s : pieces_[i]->surface.group.slices) owner_[s] = i;
    }
}

// The surface of the piece that has had most slices of a group.
std::shared_ptr<const Marched> Pieces::made_for(const KnotGroup& group) const {
    std::vector<std::uint32_t> count(pieces_.size(), 0);
    std::uint32_t most = 0;
    std::shared_ptr<const Marched> best;
    for (const Slice s : group.slices) {
        const std::uint32_t i = owner_[s];
        if (i == kNobody || !pieces_[i] || ++count[i] <= most) continue;
        most = count[i];
        best = pieces_[i]->surface.marched;
    }
    return best;
}

// Takes more for pieces that do not fit, and gives up those that cannot or are too large; false when all fit.
bool Pieces::grow_to_fit(Knots& knots, int attempt) const {
    const float radii = std::min(std::pow(kHaste, static_cast<float>(attempt)), kLongestStep);
    bool is_whole = true;
    for (const auto& piece : pieces_) {
        const KnotSurface& s = piece->surface;
        const bool is_large = s.group.slices.size() > kMaxOptional && !knots.needs(s.group);
        if (s.is_whole() && !is_large) continue;
        is_whole = false;
        if (s.is_impossible || is_large || attempt >= kMostAttempts) {
            knots.spare(s.group);
            continue;
        }
        const std::size_t before = knots.count();
        bool joined = false;
        for (const std::uint32_t seam : s.failed) knots.move_on(s.group.seams[seam], radii);
        for (const Slice beyond : s.beyond) {
            if (beyond == Slices::kNone) continue;
            knots.take_around(beyond, radii);
            joined |= knots.join(beyond, s.group.slices[0]);
        }
        if (joined || knots.count() != before) continue;
        // What it runs into is nobody's, or its own already: elsewhere, then.
        for (const Seam& seam : s.group.seams) knots.move_on(seam, radii);
    }
    return !is_whole;
}

bool Pieces::can_hold(std::span<const Segment> segments) const {
    return can_march(segments, mesh_, options_);
}

NumberSet put_into(QuadMesh& mesh, const Slices& slices, const Knots& knots, const Pieces& pieces,
                   const Context& ctx) {
    // A vertex goes with its quads, but for those of the rings.
    NumberSet gone = drop_gone(mesh, slices, knots);
    std::vector<std::vector<std::uint32_t>> rings;
    for (std::size_t i = 0; i < pieces.size(); ++i) {
        rings.push_back(ring_vertices(pieces[i].surface.group));
        for (const std::uint32_t v : rings.back()) gone.remove(v);
    }
    gone.count();
    drop_vertices(mesh, gone, ctx);
    std::size_t quads = mesh.quads.size(), vertices = mesh.positions.size();
    for (std::size_t i = 0; i < pieces.size(); ++i) {
        quads += pieces[i].quads.patch.quads.size();
        vertices += pieces[i].quads.positions.size();
    }
    mesh.quads.reserve(quads);
    mesh.positions.reserve(vertices);
    for (std::size_t i = 0; i < pieces.size(); ++i) {
        const KnotQuads& made = pieces[i].quads;
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

std::uint32_t count_bodies(const Slices& slices, const Knots& knots, const Pieces& pieces) {
    const Skeleton& s = slices.tubes();
    std::size_t members = slices.count();
    for (std::size_t i = 0; i < pieces.size(); ++i) members += pieces[i].quads.positions.size();
    DisjointSets sets(members);
    std::uint32_t count = 0;
    const auto join = [&](std::uint32_t a, std::uint32_t b) { count -= sets.join(a, b) ? 1 : 0; };
    const auto is_kept = [&](Slice i) { return i != Slices::kNone && !knots.contains(i); };
    for (const NodeId t : nodes(s)) {
        if (s.is_root(t)) {
            count += s.is_tip(t) && is_kept(slices.last(t)) ? 1 : 0;  // a ball
        } else {
            for (Slice i = slices.first(t); i <= slices.last(t); ++i) {
                if (!is_kept(i)) continue;
                ++count;
                const Slice lower = slices.next(i, false);
                if (is_kept(lower)) join(lower, i);
            }
        }
    }
    for (const NodeId n : nodes(s)) {
        if (!slices.is_fork(n)) continue;
        Slice first = Slices::kNone;
        slices.for_each_tube_at(n, [&](NodeId t) {
            const Slice here = slices.at(t, n);
            if (is_kept(first) && is_kept(here)) join(first, here);
            if (first == Slices::kNone) first = here;
        });
    }
    std::uint32_t begin = slices.count();  // of the numbers of the piece's vertices
    for (std::size_t i = 0; i < pieces.size(); ++i) {
        const KnotQuads& made = pieces[i].quads;
        std::vector<std::uint8_t> is_used(made.positions.size(), 0);
        for (const Quad& q : made.patch.quads) {
            for (const std::uint32_t v : q) {
                count += is_used[v] == 0 ? 1 : 0;
                is_used[v] = 1;
                join(begin + q[0], begin + v);
            }
        }
        std::uint32_t ring = begin;
        for (const Seam& seam : pieces[i].surface.group.seams) {
            join(ring, seam.kept);
            ring += static_cast<std::uint32_t>(seam.ring.size());
        }
        begin += static_cast<std::uint32_t>(made.positions.size());
    }
    return count;
}

}  // namespace coppice::pipeline_internal
