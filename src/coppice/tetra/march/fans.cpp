#include <algorithm>
#include <atomic>

#include "coppice/base/parallel.h"
#include "coppice/tetra/march/snapping_internal.h"

namespace coppice::tetra_internal {
namespace {

/// Collects, for each vertex, the segments that its triangles have opposite it.
class FanFinder {
  public:
    FanFinder(const TetraRefinement& refinement, const Samples& samples, const CrossedTetra& crossed,
              const Context& ctx)
        : refinement_(refinement), samples_(samples), crossed_(crossed), ctx_(ctx) {}

    std::vector<Fan> find() {
        constexpr std::size_t kGrain = 2048;
        const std::size_t count = samples_.place.size();
        size_.assign(count, 0);
        links_.resize(count);
        parallel_for(ctx_, crossed_.chunks().size(), 1, [&](std::size_t p) { list_segments(p); });
        std::vector<Fan> fans(count);
        parallel_for(ctx_, count, kGrain, [&](std::size_t i) { fans[i] = links_[i].judge(size_[i]); });
        return fans;
    }

  private:
    static constexpr std::uint32_t kMax = ListedFan::kMax;
    using Key = ListedFan::Key;
    using Segment = LinkSegment<Key>;

    void list_segments(std::size_t chunk) {
        const CrossedTetra::Chunk& p = crossed_.chunks()[chunk];
        for (std::size_t i = 0; i < p.active.size(); ++i) {
            for (const Crossing& c : p.of(i)) {
                if (c.any_on()) list_segments(p.active[i], c);
            }
        }
    }

    void list_segments(std::uint32_t t, const Crossing& crossing) {
        const auto& fine = refinement_.pattern(t).tetra[crossing.fine];
        const Cut& cut = crossing.cut();
        std::array<std::uint32_t, 4> rank{};
        std::array<Key, 4> key{};
        for (std::size_t k = 0; k < cut.size; ++k) {
            const std::uint8_t c = cut.corners[k];
            if (c >= kCutVertex) {
                const std::uint32_t v = refinement_.vertex(t, fine[c - kCutVertex]);
                rank[k] = samples_.placed.rank(v);
                key[k] = ListedFan::make_key(v, v);
            } else {
                key[k] = ListedFan::make_key(refinement_.vertex(t, fine[kTetraEdges[c][0]]),
                                             refinement_.vertex(t, fine[kTetraEdges[c][1]]));
            }
        }
        // A cut polygon with a corner at a vertex is a triangle: one corner is inside and the others are cut
        // off.
        const bool mirrored = refinement_.mirrored(t);
        for (std::size_t k = 0; k < cut.size; ++k) {
            if (cut.corners[k] < kCutVertex) continue;
            const Key next = key[(k + 1) % 3], last = key[(k + 2) % 3];
            std::atomic_ref size(size_[rank[k]]);
            if (size.load(std::memory_order_relaxed) > kMax) continue;
            const std::uint16_t at = size.fetch_add(1, std::memory_order_relaxed);
            if (at < kMax)
                links_[rank[k]].segments[at] = mirrored ? Segment{last, next} : Segment{next, last};
        }
    }

    const TetraRefinement& refinement_;
    const Samples& samples_;
    const CrossedTetra& crossed_;
    const Context& ctx_;
    std::vector<std::uint16_t>
        size_;  ///< by rank in `placed`; number of segments, counted up to just above the maximum
    Buffer<ListedFan> links_;  ///< by rank in `placed`
};

}  // namespace

std::vector<Fan> find_fans(const TetraRefinement& refinement, const Samples& samples,
                           const CrossedTetra& crossed, const Context& ctx) {
    return FanFinder(refinement, samples, crossed, ctx).find();
}

}  // namespace coppice::tetra_internal
