#include <fmt/format.h>

#include <algorithm>

#include "coppice/base/id.h"
#include "coppice/base/parallel.h"
#include "coppice/tetra/march/snapping_internal.h"
#include "coppice/tetra/march/solid_internal.h"

namespace coppice::tetra_internal {
namespace {

using Local = TetraPattern::Local;

using tetra_kernel::CutEdge;

/// A cut edge, and the vertex of the surface on it.
struct NumberedCut {
    std::uint32_t vertex;
    CutEdge edge;
};

/// Numbers on the surface of the vertices moved onto it.
struct PlacedNumbers {
    std::vector<std::uint32_t> number;  ///< by rank in Samples::placed; 2^32 - 1 for unused vertices
    std::uint32_t count = 0;            ///< number of used vertices
};

/// Numbers the used vertices in ascending order; see SnappedVertices::used.
PlacedNumbers number_placed(std::span<const std::uint8_t> used) {
    PlacedNumbers out;
    out.number.resize(used.size());
    for (std::size_t i = 0; i < used.size(); ++i) out.number[i] = used[i] != 0 ? out.count++ : kNoIndex;
    return out;
}

class Extractor {
  public:
    Extractor(const TetraRefinement& refinement, FieldRef field, const Samples& samples,
              const SnappedVertices& snapped, const Context& ctx)
        : refinement_(refinement),
          field_(field),
          profile_(field.level()),
          samples_(samples),
          view_(samples.view()),
          crossed_(snapped.crossed),
          numbers_(refinement, snapped.crossed, ctx),
          ctx_(ctx),
          placed_(number_placed(snapped.used)) {}

    ExtractedSurface extract(int refinements, bool with_solid) {
        ExtractedSurface out;
        std::vector<std::uint64_t> triangles(crossed_.chunks().size());
        for_each_chunk([&](std::size_t p, const CrossedTetra::Chunk& chunk) {
            for (const Crossing& crossing : chunk.crossings) triangles[p] += crossing.cut().size - 2u;
        });
        out.crossed = crossed_.count();
        const std::uint64_t triangle_count = exclusive_scan<std::uint64_t>(triangles);
        const std::uint64_t vertices = placed_.count + numbers_.count();
        if (vertices >= kNoIndex || triangle_count >= kNoIndex)
            throw InvalidInput("march: levels makes more than 2^32 triangles; reduce the number of levels");
        mesh_.positions.resize(vertices);
        mesh_.triangles.resize(triangle_count);
        parallel_for(ctx_, placed_.number.size(), 4096, [&](std::size_t i) {
            if (placed_.number[i] != kNoIndex) mesh_.positions[placed_.number[i]] = samples_.place[i];
        });
        ctx_.throw_if_cancelled();
        for_each_chunk([&](std::size_t p, const CrossedTetra::Chunk& chunk) {
            place_cuts(crossed_.regions(p), chunk, refinements);
        });
        ctx_.throw_if_cancelled();
        for_each_chunk([&](std::size_t p, const CrossedTetra::Chunk& chunk) {
            write_triangles(chunk, mesh_.triangles.data() + triangles[p]);
        });
        if (with_solid)
            out.solid =
                fill(refinement_, samples_, crossed_, {numbers_, placed_.number, placed_.count}, mesh_, ctx_);
        out.mesh = std::move(mesh_);
        return out;
    }

  private:
    template <class Body>
    void for_each_chunk(const Body& body) {
        const auto chunks = crossed_.chunks();
        parallel_for(ctx_, chunks.size(), 1, [&](std::size_t p) { body(p, chunks[p]); });
    }

    void place_cuts(IndexRange regions, const CrossedTetra::Chunk& chunk, int refinements) {
        CutEdges edges;
        std::vector<NumberedCut> cuts;
        std::size_t i = 0;
        for (std::size_t region = regions.begin; region < regions.end; ++region) {
            cuts.clear();
            for (; i < chunk.active.size() && chunk.active[i] < refinement_.coarse().first[region + 1]; ++i) {
                edges.assign(refinement_.pattern(chunk.active[i]), chunk.of(i));
                list_cuts(chunk.active[i], edges, cuts);
            }
            for (std::size_t c = 0; c < cuts.size(); c += kBatch)
                refine_cuts(static_cast<std::uint32_t>(region),
                            std::span(cuts).subspan(c, std::min(kBatch, cuts.size() - c)), refinements);
        }
    }

    void list_cuts(std::uint32_t t, const CutEdges& edges, std::vector<NumberedCut>& cuts) const {
        const TetraPattern& pattern = refinement_.pattern(t);
        const float clearance = refinement_.coarse().clearance;
        numbers_.for_each_owned(t, [&](std::uint32_t group, std::uint32_t number) {
            std::uint32_t vertex = placed_.count + number;
            edges.for_each(pattern, group, [&](std::uint32_t e) {
                const auto [a, b] = pattern.edges[e];
                const std::uint32_t from = refinement_.vertex(t, a), to = refinement_.vertex(t, b);
                cuts.push_back({vertex++, view_.cut_edge(from, to, refinement_.position(t, a),
                                                         refinement_.position(t, b), clearance)});
            });
        });
    }

    void refine_cuts(std::uint32_t region, std::span<NumberedCut> cuts, int refinements) {
        std::array<Vec3, kBatch> points;
        std::array<FieldSample, kBatch> samples;
        for (int round = 0;; ++round) {
            for (std::size_t i = 0; i < cuts.size(); ++i) points[i] = cuts[i].edge.point();
            if (round == refinements) break;
            field_.sample(region, std::span(points.data(), cuts.size()),
                          std::span(samples.data(), cuts.size()));
            for (std::size_t i = 0; i < cuts.size(); ++i)
                cuts[i].edge.narrow(profile_.height(samples[i].value));
        }
        for (std::size_t i = 0; i < cuts.size(); ++i) mesh_.positions[cuts[i].vertex] = points[i];
    }

    void write_triangles(const CrossedTetra::Chunk& chunk, Triangle* out) {
        CutEdges edges;
        std::vector<std::uint32_t> of_edge;
        for (std::size_t i = 0; i < chunk.active.size(); ++i) {
            const std::uint32_t t = chunk.active[i];
            const TetraPattern& pattern = refinement_.pattern(t);
            edges.assign(pattern, chunk.of(i));
            numbers_.number_edges(t, edges, of_edge);
            for (const Crossing& crossing : chunk.of(i)) {
                const Cut& cut = crossing.cut();
                const auto& fine = pattern.tetra[crossing.fine];
                std::array<std::uint32_t, 4> corners{};
                for (std::size_t k = 0; k < cut.size; ++k) {
                    const std::uint8_t c = cut.corners[k];
                    corners[k] =
                        c < kCutVertex
                            ? placed_.count + of_edge[pattern.tetra_edges[crossing.fine][c]]
                            : placed_
                                  .number[samples_.placed.rank(refinement_.vertex(t, fine[c - kCutVertex]))];
                }
                if (refinement_.mirrored(t)) tetra_kernel::turn_round(corners, cut.size);
                out = tetra_kernel::write_polygon(mesh_.positions.data(), corners, cut.size, out);
            }
        }
    }

    const TetraRefinement& refinement_;
    FieldRef field_;
    Profile profile_;
    const Samples& samples_;
    tetra_kernel::SamplesView view_;
    const CrossedTetra& crossed_;
    CutNumbers numbers_;
    const Context& ctx_;
    PlacedNumbers placed_;
    TriMesh mesh_;
};

}  // namespace

ExtractedSurface extract(const TetraRefinement& refinement, FieldRef field, const Samples& samples,
                         const SnappedVertices& snapped, int refinements, bool with_solid,
                         const Context& ctx) {
    return Extractor(refinement, field, samples, snapped, ctx).extract(refinements, with_solid);
}

}  // namespace coppice::tetra_internal
