#include <fmt/format.h>

#include <algorithm>

#include "coppice/base/parallel.h"
#include "coppice/tetra/march_internal.h"

namespace coppice::march_detail {
namespace {

using Local = TetraPattern::Local;
using Kind = TetraRefinement::Kind;

constexpr std::size_t kRegions = 16;  // of one piece of work
/// Vertices stay this share of an edge away from its ends, so that no triangle is degenerate.
constexpr float kEndShare = 0.01f;
constexpr std::uint32_t kNone = std::numeric_limits<std::uint32_t>::max();

/// A fine edge between inside and outside, the part of it that the surface crosses, and the heights at the
/// ends of that part.
struct CutEdge {
    std::uint32_t vertex;  ///< of the surface
    Vec3 a, b;             ///< the whole edge
    float low, high, at_low, at_high;
    float share;
    int last;  ///< the end moved last: -1 low, 1 high

    Vec3 point() {
        const double fall = double(at_low) - at_high;
        const float t = fall == 0 ? 0.5f : std::clamp(static_cast<float>(at_low / fall), 0.0f, 1.0f);
        share = std::clamp(low + (high - low) * t, kEndShare, 1 - kEndShare);
        return lerp(a, b, share);
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
              std::span<const std::uint8_t> used, const Context& ctx)
        : refinement_(refinement), field_(field), profile_(field.level()), samples_(samples), ctx_(ctx) {
        number_placed(used);
    }

    TriMesh extract(int refinements, MarchReport& report) {
        count();
        std::uint64_t triangles = 0;
        for (const Piece& p : pieces_) {
            triangles += p.triangles;
            report.crossed += p.crossed;
        }
        const std::uint64_t vertices = number_cuts();
        if (vertices >= kNone || triangles >= kNone)
            throw InvalidInput("march: levels makes more than 2^32 triangles; take fewer levels");
        mesh_.positions.resize(vertices);
        mesh_.triangles.resize(triangles);
        parallel_for(ctx_, placed_.size(), 4096, [&](std::size_t i) {
            if (placed_[i] != kNone) mesh_.positions[placed_[i]] = samples_.place[i];
        });
        ctx_.throw_if_cancelled();
        for_each_piece([&](Piece& piece, IndexRange regions) { place_cuts(piece, regions, refinements); });
        ctx_.throw_if_cancelled();
        std::uint64_t first = 0;
        for (Piece& p : pieces_) first += std::exchange(p.triangles, first);
        for_each_piece([&](Piece& piece, IndexRange) { write_triangles(piece); });
        return std::move(mesh_);
    }

  private:
    /// A run of regions.
    struct Piece {
        std::vector<std::uint32_t> active;  ///< coarse tetrahedra that the surface may cross
        std::uint64_t triangles = 0;        ///< first their number, then where they begin
        std::uint64_t crossed = 0;
    };

    template <class Body>
    void for_each_piece(const Body& body) {
        const std::size_t regions = refinement_.coarse().region_count();
        pieces_.resize((regions + kRegions - 1) / kRegions);
        parallel_for_ranges(ctx_, regions, kRegions,
                            [&](IndexRange r) { body(pieces_[r.begin / kRegions], r); });
    }

    void number_placed(std::span<const std::uint8_t> used) {
        placed_.resize(used.size());
        for (std::size_t i = 0; i < used.size(); ++i) placed_[i] = used[i] != 0 ? placed_count_++ : kNone;
    }

    /// Number of the part of a group among those that hold fine edges: edges, faces, insides.
    std::size_t holder(std::uint32_t t, std::uint32_t group) const {
        if (group < 10) return refinement_.parts(t)[group];
        if (group < TetraPattern::kInside) return refinement_.edge_count() + refinement_.parts(t)[group];
        return std::size_t{refinement_.edge_count()} + refinement_.face_count() + t;
    }

    void count() {
        first_cut_.assign(std::size_t{refinement_.edge_count()} + refinement_.face_count() +
                              refinement_.coarse().tetra.size(),
                          0);
        for_each_piece([&](Piece& piece, IndexRange regions) {
            LocalSigns signs;
            const auto& first = refinement_.coarse().first;
            for (std::uint32_t t = first[regions.begin]; t < first[regions.end]; ++t) {
                if (!signs.gather(refinement_, samples_, t)) continue;
                piece.active.push_back(t);
                count_cuts(t, signs);
                signs.for_each_cut(refinement_.pattern(t), [&](std::size_t, const Cut& cut) {
                    piece.triangles += cut.size - 2u;
                    ++piece.crossed;
                });
            }
        });
    }

    void count_cuts(std::uint32_t t, const LocalSigns& signs) {
        const TetraPattern& pattern = refinement_.pattern(t);
        for (std::uint32_t g = 4; g < TetraPattern::kGroups; ++g) {
            if ((refinement_.owned(t) >> g & 1) == 0) continue;
            std::uint32_t cuts = 0;
            for (std::uint32_t e = pattern.first_edge[g]; e < pattern.first_edge[g + 1]; ++e)
                cuts += signs.is_cut(pattern.edges[e]) ? 1 : 0;
            first_cut_[holder(t, g)] = cuts;
        }
    }

    std::uint64_t number_cuts() {
        std::uint64_t sum = placed_count_;
        for (std::uint32_t& c : first_cut_) {
            const std::uint32_t cuts = c;
            c = static_cast<std::uint32_t>(sum);
            sum += cuts;
        }
        return sum;
    }

    void place_cuts(Piece& piece, IndexRange regions, int refinements) {
        LocalSigns signs;
        std::vector<CutEdge> cuts;
        auto active = piece.active.begin();
        for (std::size_t region = regions.begin; region < regions.end; ++region) {
            cuts.clear();
            for (; active != piece.active.end() && *active < refinement_.coarse().first[region + 1];
                 ++active) {
                signs.gather(refinement_, samples_, *active);
                list_cuts(*active, signs, cuts);
            }
            for (std::size_t i = 0; i < cuts.size(); i += kBatch)
                settle(static_cast<std::uint32_t>(region),
                       std::span(cuts).subspan(i, std::min(kBatch, cuts.size() - i)), refinements);
        }
    }

    void list_cuts(std::uint32_t t, const LocalSigns& signs, std::vector<CutEdge>& cuts) const {
        const TetraPattern& pattern = refinement_.pattern(t);
        for (std::uint32_t g = 4; g < TetraPattern::kGroups; ++g) {
            if ((refinement_.owned(t) >> g & 1) == 0) continue;
            std::uint32_t vertex = first_cut_[holder(t, g)];
            for (std::uint32_t e = pattern.first_edge[g]; e < pattern.first_edge[g + 1]; ++e) {
                const auto [a, b] = pattern.edges[e];
                if (!signs.is_cut(pattern.edges[e])) continue;
                cuts.push_back({vertex++, refinement_.position(t, a), refinement_.position(t, b), 0, 1,
                                samples_.height[refinement_.vertex(t, a)],
                                samples_.height[refinement_.vertex(t, b)], 0.5f, 0});
            }
        }
    }

    void settle(std::uint32_t region, std::span<CutEdge> cuts, int refinements) {
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

    void write_triangles(const Piece& piece) {
        LocalSigns signs;
        std::vector<std::uint32_t> of_edge;
        Triangle* out = mesh_.triangles.data() + piece.triangles;
        for (const std::uint32_t t : piece.active) {
            signs.gather(refinement_, samples_, t);
            const TetraPattern& pattern = refinement_.pattern(t);
            number_edges(t, signs, of_edge);
            signs.for_each_cut(pattern, [&](std::size_t i, const Cut& cut) {
                const auto& fine = pattern.tetra[i];
                std::array<std::uint32_t, 4> corners{};
                for (std::size_t k = 0; k < cut.size; ++k) {
                    const std::uint8_t c = cut.corners[k];
                    corners[k] =
                        c < kCutVertex
                            ? of_edge[pattern.tetra_edges[i][c]]
                            : placed_[samples_.placed.rank(refinement_.vertex(t, fine[c - kCutVertex]))];
                }
                if (refinement_.mirrored(t)) std::reverse(corners.begin(), corners.begin() + cut.size);
                out = write_polygon(corners, cut.size, out);
            });
        }
    }

    void number_edges(std::uint32_t t, const LocalSigns& signs, std::vector<std::uint32_t>& of_edge) const {
        const TetraPattern& pattern = refinement_.pattern(t);
        of_edge.resize(pattern.edges.size());
        for (std::uint32_t g = 4; g < TetraPattern::kGroups; ++g) {
            std::uint32_t vertex = first_cut_[holder(t, g)];
            for (std::uint32_t e = pattern.first_edge[g]; e < pattern.first_edge[g + 1]; ++e) {
                of_edge[e] = vertex;
                vertex += signs.is_cut(pattern.edges[e]) ? 1 : 0;
            }
        }
    }

    Triangle* write_polygon(const std::array<std::uint32_t, 4>& c, std::size_t size, Triangle* out) const {
        if (size == 3) {
            *out++ = {c[0], c[1], c[2]};
            return out;
        }
        const auto& p = mesh_.positions;
        if (length_squared(p[c[0]] - p[c[2]]) <= length_squared(p[c[1]] - p[c[3]])) {
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
    const Context& ctx_;
    std::vector<Piece> pieces_;
    std::vector<std::uint32_t> placed_;  ///< vertex of the surface, by rank in samples_.placed
    std::uint32_t placed_count_ = 0;
    Buffer<std::uint32_t> first_cut_;  ///< by holder: vertex of the surface on its first cut edge
    TriMesh mesh_;
};

}  // namespace

TriMesh extract(const TetraRefinement& refinement, FieldRef field, const Samples& samples,
                std::span<const std::uint8_t> used, int refinements, MarchReport& report,
                const Context& ctx) {
    return Extractor(refinement, field, samples, used, ctx).extract(refinements, report);
}

}  // namespace coppice::march_detail
