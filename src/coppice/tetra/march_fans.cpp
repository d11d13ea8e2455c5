#include <atomic>

#include "coppice/base/parallel.h"
#include "coppice/tetra/march_settle_internal.h"

namespace coppice::march_detail {
namespace {

using Local = TetraPattern::Local;

/// Collects the segments that all triangles leave over by the vertex that they leave out.
class FanFinder {
  public:
    FanFinder(const TetraRefinement& refinement, const Samples& samples, const CrossedTetra& crossed,
              const Context& ctx)
        : refinement_(refinement),
          samples_(samples),
          crossed_(crossed),
          numbers_(refinement, crossed, ctx),
          ctx_(ctx) {}

    std::vector<Fan> find() {
        constexpr std::size_t kGrain = 2048;
        const std::size_t count = samples_.place.size();
        if (count >= kEdge || numbers_.count() >= kEdge)
            throw InvalidInput("march: levels makes more than 2^31 vertices; take fewer levels");
        size_.assign(count, 0);
        links_.resize(count);
        parallel_for(ctx_, crossed_.pieces().size(), 1, [&](std::size_t p) { list_segments(p); });
        std::vector<Fan> fans(count);
        parallel_for(ctx_, count, kGrain, [&](std::size_t i) {
            fans[i] = size_[i] > kMost ? Fan::unknown
                                       : judge_fan<std::uint32_t>(std::span(links_[i]).first(size_[i]));
        });
        return fans;
    }

  private:
    static constexpr std::uint32_t kMost = 8;
    static constexpr std::uint32_t kEdge = 1u << 31;  ///< above all ranks
    using Segment = LinkSegment<std::uint32_t>;
    using Link = std::array<Segment, kMost>;

    void list_segments(std::size_t piece) {
        const CrossedTetra::Piece& p = crossed_.pieces()[piece];
        CutEdges edges;
        std::vector<std::uint32_t> number;  // by fine edge
        for (std::size_t i = 0; i < p.active.size(); ++i) {
            const std::uint32_t t = p.active[i];
            edges.assign(refinement_.pattern(t), p.of(i));
            numbers_.number_edges(t, edges, number);
            for (const Crossing& c : p.of(i)) {
                if (c.any_on()) list_segments(t, c, number);
            }
        }
    }

    void list_segments(std::uint32_t t, const Crossing& crossing, const std::vector<std::uint32_t>& number) {
        const TetraPattern& pattern = refinement_.pattern(t);
        const auto& fine = pattern.tetra[crossing.fine];
        const Cut& cut = crossing.cut();
        std::array<std::uint32_t, 4> corner{};
        for (std::size_t k = 0; k < cut.size; ++k) {
            const std::uint8_t c = cut.corners[k];
            corner[k] = c < kCutVertex ? kEdge | number[pattern.tetra_edges[crossing.fine][c]]
                                       : samples_.placed.rank(refinement_.vertex(t, fine[c - kCutVertex]));
        }
        // A cut with a corner in a vertex has three corners: one inside and the others are cut off.
        const bool mirrored = refinement_.mirrored(t);
        for (std::size_t k = 0; k < cut.size; ++k) {
            if (corner[k] >= kEdge) continue;
            const std::uint32_t next = corner[(k + 1) % 3], last = corner[(k + 2) % 3];
            const std::uint32_t at =
                std::atomic_ref(size_[corner[k]]).fetch_add(1, std::memory_order_relaxed);
            if (at < kMost) links_[corner[k]][at] = mirrored ? Segment{last, next} : Segment{next, last};
        }
    }

    const TetraRefinement& refinement_;
    const Samples& samples_;
    const CrossedTetra& crossed_;
    CutNumbers numbers_;
    const Context& ctx_;
    std::vector<std::uint32_t> size_;  ///< by rank in `placed`
    Buffer<Link> links_;               ///< the same; segments in any order
};

}  // namespace

std::vector<Fan> find_fans(const TetraRefinement& refinement, const Samples& samples,
                           const CrossedTetra& crossed, const Context& ctx) {
    return FanFinder(refinement, samples, crossed, ctx).find();
}

}  // namespace coppice::march_detail
