#include "coppice/tetra/march/held_internal.h"

#include <algorithm>
#include <bit>
#include <optional>

#include "coppice/base/disjoint_sets.h"
#include "coppice/base/parallel.h"
#include "coppice/base/sort.h"
#include "coppice/tetra/march/kernel/axis_kernel.h"

namespace coppice::tetra_internal {
namespace {

using Local = TetraPattern::Local;
using tetra_kernel::FineLineTable;

/// Finds the held vertices of regions.
class Holder {
  public:
    Holder(const TetraRefinement& refinement, const InsideAxes& axes, std::span<const FineLineTable> lines)
        : refinement_(refinement), axes_(axes), lines_(lines) {}

    void find(std::uint32_t region, std::vector<HeldVertex>& out) {
        const auto passing = axes_.passing[region];
        if (passing.empty()) return;
        describe(region);
        for (const std::uint32_t s : passing) {
            const std::size_t begin = out.size();
            const tetra_kernel::AxisLine line(axes_.segments[s]);
            for (Coarse& c : coarse_) {
                if (!c.shape.is_near(line)) continue;
                if (!c.weights) c.weights.emplace(get_corners(c.tetra));
                look_at(c.tetra, *c.weights, s, begin, out);
            }
        }
    }

  private:
    struct Coarse {
        std::uint32_t tetra;
        tetra_kernel::HeldTetra shape;
        std::optional<tetra_kernel::WeightFunctions> weights;  ///< computed when an axis is close
    };

    tetra_kernel::Corners get_corners(std::uint32_t t) const {
        return tetra_kernel::get_corners(refinement_.coarse().positions.data(), refinement_.elements(t));
    }

    void describe(std::uint32_t region) {
        coarse_.clear();
        const TetraMesh& mesh = refinement_.coarse();
        for (std::uint32_t t = mesh.first[region]; t < mesh.first[region + 1]; ++t)
            coarse_.push_back({t, tetra_kernel::HeldTetra(get_corners(t)), {}});
    }

    /// Appends the vertices of a coarse tetrahedron that an axis holds and that are not in `out` from `begin`
    /// on.
    void look_at(std::uint32_t t, const tetra_kernel::WeightFunctions& weights, std::uint32_t segment,
                 std::size_t begin, std::vector<HeldVertex>& out) {
        const auto hold = [&](Local local) {
            const std::uint32_t vertex = refinement_.vertex(t, local);
            const auto seen = std::span(out).subspan(begin);
            if (std::ranges::find(seen, vertex, &HeldVertex::vertex) == seen.end())
                out.push_back({vertex, segment, t, local});
        };
        tetra_kernel::visit_held(weights, lines_[refinement_.diagonal(t)].line(), axes_.segments[segment],
                                 hold);
    }

    const TetraRefinement& refinement_;
    const InsideAxes& axes_;
    std::span<const FineLineTable> lines_;  ///< by diagonal
    std::vector<Coarse> coarse_;            ///< of the current region
};

/// Returns held vertices, ascending; those of one vertex in the order of regions.
Buffer<HeldVertex> find_held(const TetraRefinement& refinement, const InsideAxes& axes, const Context& ctx) {
    constexpr std::size_t kRegions = 64;
    const std::size_t regions = refinement.coarse().region_count();
    std::vector<std::vector<HeldVertex>> found((regions + kRegions - 1) / kRegions);
    std::vector<FineLineTable> lines;
    for (std::uint32_t d = 0; d < 3; ++d) lines.emplace_back(refinement.pattern_along(d), d);
    parallel_for_ranges(ctx, regions, kRegions, [&](IndexRange range) {
        if (ctx.stop.stop_requested()) return;
        Holder holder(refinement, axes, lines);
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
            return tetra_kernel::squared_distance(axes.segments[segment], place);
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
