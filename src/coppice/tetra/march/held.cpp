#include "coppice/tetra/march/held_internal.h"

#include <algorithm>
#include <array>
#include <bit>
#include <optional>

#include "coppice/base/disjoint_sets.h"
#include "coppice/base/parallel.h"
#include "coppice/base/segment_distance.h"
#include "coppice/base/sort.h"

namespace coppice::tetra_internal {
namespace {

using Local = TetraPattern::Local;
using Weights = std::array<double, 4>;  ///< barycentric coordinates

/// Weights this far below a bound count as at it: rounding finds a vertex too many, never one too few.
constexpr double kSlack = 1e-6;

/// The part of a line, from 0 to 1, in which linear functions are not negative.
struct Span {
    double from = 0, to = 1;

    void clip(double at_start, double at_end) {
        at_start += kSlack;
        at_end += kSlack;
        if (at_start < 0 && at_end < 0) {
            to = -1;
        } else if (at_start < 0) {
            from = std::max(from, at_start / (at_start - at_end));
        } else if (at_end < 0) {
            to = std::min(to, at_start / (at_start - at_end));
        }
    }
    bool empty() const { return from > to; }
};

/// The weights in a tetrahedron as linear functions of space.
class WeightFunctions {
  public:
    explicit WeightFunctions(const std::array<Vec3d, 4>& p) : origin_(p[0]) {
        const Vec3d x = p[1] - p[0], y = p[2] - p[0], z = p[3] - p[0];
        const double volume = dot(cross(x, y), z);
        slope_ = {cross(y, z) / volume, cross(z, x) / volume, cross(x, y) / volume};
    }

    Weights at(Vec3d p) const {
        const Vec3d w = p - origin_;
        const double x = dot(slope_[0], w), y = dot(slope_[1], w), z = dot(slope_[2], w);
        return {1 - x - y - z, x, y, z};
    }

  private:
    Vec3d origin_;
    std::array<Vec3d, 3> slope_;
};

/// A place by its weights in a coarse tetrahedron; the first follows from the others.
Vec3d place_of(const Weights& w) { return {w[1], w[2], w[3]}; }

/// The part of the line between two points in which all weights are those of a point inside.
Span within(const Weights& start, const Weights& end) {
    Span span;
    for (std::size_t i = 0; i < 4; ++i) {
        // Mostly it misses, which takes no division to see.
        if (start[i] < -kSlack && end[i] < -kSlack) return {1, 0};
    }
    for (std::size_t i = 0; i < 4; ++i) span.clip(start[i], end[i]);
    return span;
}

/// Weights in each fine tetrahedron by those in the coarse one.
std::vector<WeightFunctions> fine_weights(const TetraPattern& pattern) {
    std::vector<WeightFunctions> out;
    for (const auto& fine : pattern.tetra) {
        std::array<Vec3d, 4> corners;
        for (std::size_t i = 0; i < 4; ++i) {
            const auto& share = pattern.shares[fine[i]];
            corners[i] = {share[1], share[2], share[3]};
        }
        out.emplace_back(corners);
    }
    return out;
}

using FineWeights = std::array<std::vector<WeightFunctions>, 3>;  ///< by diagonal

/// Finds the held vertices of one region after the other.
class Holder {
  public:
    Holder(const TetraRefinement& refinement, const InsideAxes& axes, const FineWeights& fine_weights)
        : refinement_(refinement), axes_(axes), fine_weights_(fine_weights) {}

    void find(std::uint32_t region, std::vector<HeldVertex>& out) {
        const auto passing = axes_.passing[region];
        if (passing.empty()) return;
        describe(region);
        for (const std::uint32_t s : passing) {
            const std::size_t begin = out.size();
            const Vec3d a(axes_.segments[s].a), b(axes_.segments[s].b), along = b - a;
            for (Coarse& c : coarse_) {
                const Vec3d foot = a + along * closest_parameter(c.middle, a, along);
                if (length_squared(foot - c.middle) > c.reach_squared) continue;
                if (!c.weights) c.weights.emplace(corners_of(c.tetra));
                look_at(c.tetra, c.weights->at(a), c.weights->at(b), s, begin, out);
            }
        }
    }

  private:
    /// A coarse tetrahedron, and a ball about it.
    struct Coarse {
        std::uint32_t tetra;
        Vec3d middle;
        double reach_squared;
        std::optional<WeightFunctions> weights;  ///< once an axis comes near
    };

    std::array<Vec3d, 4> corners_of(std::uint32_t t) const {
        std::array<Vec3d, 4> p;
        for (std::size_t i = 0; i < 4; ++i)
            p[i] = Vec3d(refinement_.coarse().positions[refinement_.parts(t)[i]]);
        return p;
    }

    void describe(std::uint32_t region) {
        coarse_.clear();
        const TetraMesh& mesh = refinement_.coarse();
        for (std::uint32_t t = mesh.first[region]; t < mesh.first[region + 1]; ++t) {
            const std::array<Vec3d, 4> p = corners_of(t);
            const Vec3d middle = 0.25 * (p[0] + p[1] + p[2] + p[3]);
            double reach = 0;
            for (const Vec3d c : p) reach = std::max(reach, length_squared(c - middle));
            coarse_.push_back({t, middle, (1 + kSlack) * reach, {}});
        }
    }

    /// Appends what the axis between two points of a coarse tetrahedron needs, and what is not in `out` from
    /// `begin` on.
    void look_at(std::uint32_t t, const Weights& start, const Weights& end, std::uint32_t segment,
                 std::size_t begin, std::vector<HeldVertex>& out) const {
        if (within(start, end).empty()) return;
        const TetraPattern& pattern = refinement_.pattern(t);
        const auto& fine = fine_weights_[refinement_.diagonal(t)];
        for (std::size_t f = 0; f < pattern.tetra.size(); ++f) {
            const Weights a = fine[f].at(place_of(start)), b = fine[f].at(place_of(end));
            const Span span = within(a, b);
            if (span.empty()) continue;
            for (std::size_t i = 0; i < 4; ++i) {
                Span greatest = span;
                for (std::size_t j = 0; j < 4; ++j) {
                    if (j != i) greatest.clip(a[i] - a[j], b[i] - b[j]);
                }
                if (greatest.empty()) continue;
                const Local local = pattern.tetra[f][i];
                const std::uint32_t vertex = refinement_.vertex(t, local);
                const auto seen = std::span(out).subspan(begin);
                if (std::ranges::find(seen, vertex, &HeldVertex::vertex) == seen.end())
                    out.push_back({vertex, segment, t, local});
            }
        }
    }

    const TetraRefinement& refinement_;
    const InsideAxes& axes_;
    const FineWeights& fine_weights_;
    std::vector<Coarse> coarse_;  ///< of one region
};

/// Ascending by vertex; of each, in the order of regions.
Buffer<HeldVertex> find_held(const TetraRefinement& refinement, const InsideAxes& axes, const Context& ctx) {
    constexpr std::size_t kRegions = 64;
    FineWeights weights;
    for (std::uint32_t d = 0; d < 3; ++d) weights[d] = fine_weights(refinement.pattern_along(d));
    const std::size_t regions = refinement.coarse().region_count();
    std::vector<std::vector<HeldVertex>> found((regions + kRegions - 1) / kRegions);
    parallel_for_ranges(ctx, regions, kRegions, [&](IndexRange range) {
        if (ctx.stop.stop_requested()) return;
        Holder holder(refinement, axes, weights);
        for (std::size_t r = range.begin; r < range.end; ++r)
            holder.find(static_cast<std::uint32_t>(r), found[r / kRegions]);
    });
    ctx.throw_if_cancelled();
    Buffer<HeldVertex> all;
    for (const auto& part : found) all.insert(all.end(), part.begin(), part.end());
    radix_sort(ctx, all, static_cast<unsigned>(std::bit_width(refinement.vertex_count())),
               [](const HeldVertex& h) { return h.vertex; });
    return all;
}

}  // namespace

HeldVertices hold_axes(const TetraRefinement& refinement, const InsideAxes& axes, const Context& ctx) {
    HeldVertices out{RankedBits(refinement.vertex_count()), {}, {}};
    if (axes.segments.empty()) return out;
    const Buffer<HeldVertex> found = find_held(refinement, axes, ctx);
    DisjointSets sets(axes.segments.size());
    for (std::size_t i = 0; i < found.size();) {
        const HeldVertex& first = found[i];
        const Vec3d place(refinement.position(first.tetra, first.local));
        const auto away = [&](std::uint32_t segment) {
            const Segment& s = axes.segments[segment];
            const Vec3d a(s.a), along = Vec3d(s.b) - a;
            return length_squared(a + along * closest_parameter(place, a, along) - place);
        };
        HeldVertex nearest = first;
        double least = away(first.segment);
        for (++i; i < found.size() && found[i].vertex == first.vertex; ++i) {
            sets.join(first.segment, found[i].segment);
            const double d = away(found[i].segment);
            if (d > least || (d == least && found[i].segment >= nearest.segment)) continue;
            least = d;
            nearest.segment = found[i].segment;
        }
        out.bits.set(first.vertex);
        out.list.push_back(nearest);
    }
    std::vector<std::uint8_t> seen(axes.segments.size());
    for (std::uint32_t i = 0; i < out.list.size(); ++i) {
        std::uint8_t& named = seen[sets.find(out.list[i].segment)];
        if (named == 0) out.of_each_set.push_back(i);
        named = 1;
    }
    return out;
}

}  // namespace coppice::tetra_internal
