#include <fmt/format.h>

#include <algorithm>

#include "coppice/base/parallel.h"
#include "coppice/tetra/march/snapping_internal.h"
#include "coppice/tetra/march/solid_internal.h"
#include "coppice/tetra/none_internal.h"

namespace coppice::tetra_internal {
namespace {

using Local = TetraPattern::Local;

/// Where a vertex holds an axis that lies near the surface, the branch is not thinner than this.
constexpr float kThinnest = 0.5f;  // [radii]
/// A fine edge between inside and outside, the part of it that the surface crosses, and the heights at the
/// ends of that part.
struct CutEdge {
    std::uint32_t vertex;  ///< of the surface
    Vec3 a, b;             ///< the whole edge
    float low, high, at_low, at_high;
    float least, most;  ///< shares of the edge: it may cross nowhere else
    float share = 0.5f;
    int last = 0;  ///< the end moved last: -1 low, 1 high

    Vec3 point() {
        const double fall = double(at_low) - at_high;
        const float t = fall == 0 ? 0.5f : std::clamp(static_cast<float>(at_low / fall), 0.0f, 1.0f);
        share = std::clamp(low + (high - low) * t, least, most);
        return lerp(a, b, share);
    }

    /// Keeps a branch thick about the end that holds its axis, and is `away` from it. Where the field says
    /// that this end is outside, it says nothing of how thick, but the axis does.
    void thicken(const WeakVertex& held, float height, float away, bool at_a) {
        const bool sunken = height <= 0;
        const float thick =
            sunken ? std::max(held.radius - away, kThinnest * held.radius) : kThinnest * held.radius;
        const float part = std::clamp(thick / distance(a, b), least, 0.5f);
        if (at_a || sunken) least = at_a ? part : 1 - part;
        if (!at_a || sunken) most = at_a ? part : 1 - part;
    }

    /// Regula falsi; an end that stays for the second time counts for less, by as much as the curve bends
    /// [Anderson1973].
    void narrow(float height) {
        const bool moves_low = (height > 0) == (at_low > 0);
        float &moved = moves_low ? at_low : at_high, &stays = moves_low ? at_high : at_low;
        const int end = moves_low ? -1 : 1;
        if (last == end) {
            const float part = 1 - height / moved;
            stays *= part > 0 ? part : 0.5f;
        }
        (moves_low ? low : high) = share;
        moved = height;
        last = end;
    }
};

class Extractor {
  public:
    Extractor(const TetraRefinement& refinement, FieldRef field, const Samples& samples,
              const SnappedVertices& snapped, const Context& ctx)
        : refinement_(refinement),
          field_(field),
          profile_(field.level()),
          samples_(samples),
          crossed_(snapped.crossed),
          numbers_(refinement, snapped.crossed, ctx),
          ctx_(ctx) {
        number_placed(snapped.used);
    }

    ExtractedSurface extract(int refinements, bool with_solid) {
        ExtractedSurface out;
        std::vector<std::uint64_t> triangles(crossed_.pieces().size());
        for_each_piece([&](std::size_t p, const CrossedTetra::Piece& piece) {
            for (const Crossing& crossing : piece.crossings) triangles[p] += crossing.cut().size - 2u;
        });
        for (const CrossedTetra::Piece& piece : crossed_.pieces()) out.crossed += piece.crossings.size();
        const std::uint64_t triangle_count = exclusive_scan<std::uint64_t>(triangles);
        const std::uint64_t vertices = placed_count_ + numbers_.count();
        if (vertices >= kNone || triangle_count >= kNone)
            throw InvalidInput("march: levels makes more than 2^32 triangles; take fewer levels");
        mesh_.positions.resize(vertices);
        mesh_.triangles.resize(triangle_count);
        parallel_for(ctx_, placed_.size(), 4096, [&](std::size_t i) {
            if (placed_[i] != kNone) mesh_.positions[placed_[i]] = samples_.place[i];
        });
        ctx_.throw_if_cancelled();
        for_each_piece([&](std::size_t p, const CrossedTetra::Piece& piece) {
            place_cuts(crossed_.regions(p), piece, refinements);
        });
        ctx_.throw_if_cancelled();
        for_each_piece([&](std::size_t p, const CrossedTetra::Piece& piece) {
            write_triangles(piece, mesh_.triangles.data() + triangles[p]);
        });
        if (with_solid)
            out.solid =
                fill(refinement_, samples_, crossed_, {numbers_, placed_, placed_count_}, mesh_, ctx_);
        out.mesh = std::move(mesh_);
        return out;
    }

  private:
    template <class Body>
    void for_each_piece(const Body& body) {
        const auto pieces = crossed_.pieces();
        parallel_for(ctx_, pieces.size(), 1, [&](std::size_t p) { body(p, pieces[p]); });
    }

    void number_placed(std::span<const std::uint8_t> used) {
        placed_.resize(used.size());
        for (std::size_t i = 0; i < used.size(); ++i) placed_[i] = used[i] != 0 ? placed_count_++ : kNone;
    }

    void place_cuts(IndexRange regions, const CrossedTetra::Piece& piece, int refinements) {
        CutEdges edges;
        std::vector<CutEdge> cuts;
        std::size_t i = 0;
        for (std::size_t region = regions.begin; region < regions.end; ++region) {
            cuts.clear();
            for (; i < piece.active.size() && piece.active[i] < refinement_.coarse().first[region + 1]; ++i) {
                edges.assign(refinement_.pattern(piece.active[i]), piece.of(i));
                list_cuts(piece.active[i], edges, cuts);
            }
            for (std::size_t c = 0; c < cuts.size(); c += kBatch)
                refine_cuts(static_cast<std::uint32_t>(region),
                            std::span(cuts).subspan(c, std::min(kBatch, cuts.size() - c)), refinements);
        }
    }

    void list_cuts(std::uint32_t t, const CutEdges& edges, std::vector<CutEdge>& cuts) const {
        const TetraPattern& pattern = refinement_.pattern(t);
        const float clearance = refinement_.coarse().clearance;
        numbers_.for_each_owned(t, [&](std::uint32_t group, std::uint32_t number) {
            std::uint32_t vertex = placed_count_ + number;
            edges.for_each(pattern, group, [&](std::uint32_t e) {
                const auto [a, b] = pattern.edges[e];
                const std::uint32_t from = refinement_.vertex(t, a), to = refinement_.vertex(t, b);
                cuts.push_back({vertex++, refinement_.position(t, a), refinement_.position(t, b), 0, 1,
                                samples_.height[from], samples_.height[to], clearance, 1 - clearance});
                if (samples_.held.test(from)) hold(from, true, cuts.back());
                if (samples_.held.test(to)) hold(to, false, cuts.back());
            });
        });
    }

    /// An end of an edge that holds an axis may have been moved.
    void hold(std::uint32_t vertex, bool at_a, CutEdge& edge) const {
        const auto weak = std::ranges::lower_bound(samples_.weak, vertex, {}, &WeakVertex::vertex);
        if (weak == samples_.weak.end() || weak->vertex != vertex) return;
        float& height = at_a ? edge.at_low : edge.at_high;
        float away = weak->away;
        if (samples_.moved.test(vertex)) {
            const std::uint32_t rank = samples_.placed.rank(vertex);
            (at_a ? edge.a : edge.b) = samples_.place[rank];
            height = weak->height;
            away -= samples_.way[rank];
        }
        edge.thicken(*weak, height, away, at_a);
    }

    void refine_cuts(std::uint32_t region, std::span<CutEdge> cuts, int refinements) {
        std::array<Vec3, kBatch> points;
        std::array<FieldSample, kBatch> samples;
        for (int round = 0;; ++round) {
            for (std::size_t i = 0; i < cuts.size(); ++i) points[i] = cuts[i].point();
            if (round == refinements) break;
            field_.sample(region, std::span(points.data(), cuts.size()),
                          std::span(samples.data(), cuts.size()));
            for (std::size_t i = 0; i < cuts.size(); ++i) cuts[i].narrow(profile_.height(samples[i].value));
        }
        for (std::size_t i = 0; i < cuts.size(); ++i) mesh_.positions[cuts[i].vertex] = points[i];
    }

    void write_triangles(const CrossedTetra::Piece& piece, Triangle* out) {
        CutEdges edges;
        std::vector<std::uint32_t> of_edge;
        for (std::size_t i = 0; i < piece.active.size(); ++i) {
            const std::uint32_t t = piece.active[i];
            const TetraPattern& pattern = refinement_.pattern(t);
            edges.assign(pattern, piece.of(i));
            numbers_.number_edges(t, edges, of_edge);
            for (const Crossing& crossing : piece.of(i)) {
                const Cut& cut = crossing.cut();
                const auto& fine = pattern.tetra[crossing.fine];
                std::array<std::uint32_t, 4> corners{};
                for (std::size_t k = 0; k < cut.size; ++k) {
                    const std::uint8_t c = cut.corners[k];
                    corners[k] =
                        c < kCutVertex
                            ? placed_count_ + of_edge[pattern.tetra_edges[crossing.fine][c]]
                            : placed_[samples_.placed.rank(refinement_.vertex(t, fine[c - kCutVertex]))];
                }
                if (refinement_.mirrored(t)) std::reverse(corners.begin(), corners.begin() + cut.size);
                out = write_polygon(corners, cut.size, out);
            }
        }
    }

    Triangle* write_polygon(const std::array<std::uint32_t, 4>& c, std::size_t size, Triangle* out) const {
        if (size == 3) {
            *out++ = {c[0], c[1], c[2]};
            return out;
        }
        if (cut_from_first(mesh_.positions, c)) {
            *out++ = {c[0], c[1], c[2]};
            *out++ = {c[0], c[2], c[3]};
        } else {
            *out++ = {c[0], c[1], c[3]};
            *out++ = {c[1], c[2], c[3]};
        }
        return out;
    }

    const TetraRefinement& refinement_;
    FieldRef field_;
    Profile profile_;
    const Samples& samples_;
    const CrossedTetra& crossed_;
    CutNumbers numbers_;
    const Context& ctx_;
    std::vector<std::uint32_t> placed_;  ///< vertex of the surface, by rank in samples_.placed
    std::uint32_t placed_count_ = 0;
    TriMesh mesh_;
};

}  // namespace

ExtractedSurface extract(const TetraRefinement& refinement, FieldRef field, const Samples& samples,
                         const SnappedVertices& snapped, int refinements, bool with_solid,
                         const Context& ctx) {
    return Extractor(refinement, field, samples, snapped, ctx).extract(refinements, with_solid);
}

}  // namespace coppice::tetra_internal
