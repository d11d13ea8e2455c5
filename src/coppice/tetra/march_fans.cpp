#include <atomic>
#include <limits>
#include <utility>

#include "coppice/base/parallel.h"
#include "coppice/tetra/march_settle_internal.h"

namespace coppice::march_detail {
namespace {

using Local = TetraPattern::Local;

/// Sorts the segments that all triangles leave over by the vertex that they leave out.
class FanFinder {
  public:
    FanFinder(const TetraRefinement& refinement, const Samples& samples, const CrossedTetra& crossed,
              const Context& ctx)
        : refinement_(refinement), samples_(samples), crossed_(crossed), ctx_(ctx) {}

    std::vector<Fan> find() {
        constexpr std::size_t kGrain = 2048;
        const std::size_t count = samples_.place.size();
        first_.assign(count + 1, 0);
        parallel_for(ctx_, crossed_.pieces().size(), 1, [&](std::size_t p) { count_segments(p); });
        segments_.resize(number_segments());
        next_ = first_;
        parallel_for(ctx_, crossed_.pieces().size(), 1, [&](std::size_t p) { list_segments(p); });
        std::vector<Fan> fans(count);
        parallel_for(ctx_, count, kGrain, [&](std::size_t i) {
            fans[i] = judge_fan(std::span(segments_).subspan(first_[i], first_[i + 1] - first_[i]));
        });
        return fans;
    }

  private:
    std::size_t number_segments() {
        std::uint64_t sum = 0;
        for (std::uint32_t& n : first_) sum += std::exchange(n, static_cast<std::uint32_t>(sum));
        if (sum > std::numeric_limits<std::uint32_t>::max())
            throw InvalidInput("march: levels makes more than 2^32 corners of triangles; take fewer levels");
        return sum;
    }

    std::uint32_t rank(std::uint32_t t, const Crossing& crossing, std::uint8_t corner) const {
        return samples_.placed.rank(vertex(t, crossing, corner));
    }
    std::uint32_t vertex(std::uint32_t t, const Crossing& crossing, std::uint8_t corner) const {
        return refinement_.vertex(t, refinement_.pattern(t).tetra[crossing.fine][corner - kCutVertex]);
    }

    void count_segments(std::size_t piece) {
        const CrossedTetra::Piece& p = crossed_.pieces()[piece];
        for (std::size_t i = 0; i < p.active.size(); ++i) {
            for (const Crossing& c : p.of(i)) {
                for (std::size_t k = 0; k < c.cut().size; ++k) {
                    if (c.cut().corners[k] < kCutVertex) continue;
                    std::atomic_ref(first_[rank(p.active[i], c, c.cut().corners[k])])
                        .fetch_add(1, std::memory_order_relaxed);
                }
            }
        }
    }

    void list_segments(std::size_t piece) {
        const CrossedTetra::Piece& p = crossed_.pieces()[piece];
        CutEdges edges;
        std::vector<std::uint64_t> key;  // by fine edge
        for (std::size_t i = 0; i < p.active.size(); ++i) {
            const std::uint32_t t = p.active[i];
            edges.assign(refinement_.pattern(t), p.of(i));
            number_edges(t, edges, key);
            for (const Crossing& c : p.of(i)) list_segments(t, c, key);
        }
    }

    void number_edges(std::uint32_t t, const CutEdges& edges, std::vector<std::uint64_t>& key) const {
        const TetraPattern& pattern = refinement_.pattern(t);
        key.resize(pattern.edges.size());
        for (std::uint32_t g = 4; g < TetraPattern::kGroups; ++g) {
            const std::uint64_t holder = std::uint64_t{edge_holder(refinement_, t, g)} << 16;
            edges.for_each(pattern, g,
                           [&](std::uint32_t e) { key[e] = holder | (e - pattern.first_edge[g]); });
        }
    }

    void list_segments(std::uint32_t t, const Crossing& crossing, const std::vector<std::uint64_t>& key) {
        // Above all holders of edges.
        constexpr std::uint64_t kVertex = std::uint64_t{1} << 63;
        const Cut& cut = crossing.cut();
        std::array<std::uint64_t, 4> corner{};
        bool any = false;
        for (std::size_t k = 0; k < cut.size; ++k) {
            const std::uint8_t c = cut.corners[k];
            any |= c >= kCutVertex;
            corner[k] = c >= kCutVertex ? kVertex | vertex(t, crossing, c)
                                        : key[refinement_.pattern(t).tetra_edges[crossing.fine][c]];
        }
        if (!any) return;
        // A cut with a corner in a vertex has three corners: one inside and the others are cut off.
        const bool mirrored = refinement_.mirrored(t);
        for (std::size_t k = 0; k < 3; ++k) {
            if (cut.corners[k] < kCutVertex) continue;
            const std::uint64_t next = corner[(k + 1) % 3], last = corner[(k + 2) % 3];
            const std::uint32_t at = std::atomic_ref(next_[rank(t, crossing, cut.corners[k])])
                                         .fetch_add(1, std::memory_order_relaxed);
            segments_[at] = mirrored ? LinkSegment{last, next} : LinkSegment{next, last};
        }
    }

    const TetraRefinement& refinement_;
    const Samples& samples_;
    const CrossedTetra& crossed_;
    const Context& ctx_;
    std::vector<std::uint32_t> first_, next_;  ///< by rank in `placed`
    Buffer<LinkSegment> segments_;             ///< those of one vertex in any order
};

}  // namespace

Fan judge_fan(std::span<const LinkSegment> segments) {
    if (segments.empty()) return Fan::none;
    // From each segment to the first that goes on from its end: only from a single closed way without a
    // corner that it comes to twice does this see all segments before it is back.
    std::size_t at = 0, steps = 0;
    do {
        std::size_t next = 0;
        while (next < segments.size() && segments[next].from != segments[at].to) ++next;
        if (next == segments.size()) return Fan::spoilt;
        at = next;
        ++steps;
    } while (at != 0 && steps < segments.size());
    return at == 0 && steps == segments.size() && steps >= 3 ? Fan::single : Fan::spoilt;
}

std::vector<Fan> find_fans(const TetraRefinement& refinement, const Samples& samples,
                           const CrossedTetra& crossed, const Context& ctx) {
    return FanFinder(refinement, samples, crossed, ctx).find();
}

}  // namespace coppice::march_detail
