#include <algorithm>

#include "coppice/tetra/march/kernel/fold_kernel.h"
#include "coppice/tetra/march/snapping_internal.h"

namespace coppice::tetra_internal {
namespace {

using Local = TetraPattern::Local;
using Fine = std::array<Local, 4>;

/// Checks the fine tetrahedra of coarse ones.
class FoldFinder {
  public:
    FoldFinder(const TetraRefinement& refinement, const Samples& samples)
        : refinement_(refinement), samples_(samples) {}

    /// Calls use(vertex) for the vertex that moved farthest in each fine tetrahedron that is too flat.
    template <class Use>
    void look_at(std::uint32_t t, const Use& use) {
        const float least = tetra_kernel::harmless_way(refinement_.width(t));
        if (!gather_ways(t, least)) return;
        const TetraPattern& pattern = refinement_.pattern(t);
        const bool small = !pattern.tetra_masks.empty();
        placed_ = false;
        for (std::size_t i = 0; i < pattern.tetra.size(); ++i) {
            if (small && (moved_[0] & pattern.tetra_masks[i]) == 0) continue;
            const Fine& fine = pattern.tetra[i];
            // The tetrahedron cannot be inverted while the total distance of the two that moved farthest is
            // less than its width.
            const std::array<float, 4> way{way_[fine[0]], way_[fine[1]], way_[fine[2]], way_[fine[3]]};
            if (tetra_kernel::two_longest(way) <= least) continue;
            if (!placed_) place(t);
            if (tetra_kernel::is_flat(
                    {position_[fine[0]], position_[fine[1]], position_[fine[2]], position_[fine[3]]},
                    volume_))
                use(tetra_kernel::farthest({refinement_.vertex(t, fine[0]), refinement_.vertex(t, fine[1]),
                                            refinement_.vertex(t, fine[2]), refinement_.vertex(t, fine[3])},
                                           way));
        }
    }

  private:
    /// Gathers the distances that the vertices moved. Returns false if no two of them moved by more than
    /// `least` in total.
    bool gather_ways(std::uint32_t t, float least) {
        gather_bits(refinement_, samples_.moved, t, moved_);
        const std::size_t count = refinement_.pattern(t).weights.size();
        way_.assign(count, 0);
        float longest = 0, second = 0;
        for (std::size_t w = 0; w <= count / 64; ++w) {
            for (std::uint64_t rest = moved_[w]; rest != 0; rest &= rest - 1) {
                const std::size_t v = 64 * w + static_cast<std::size_t>(std::countr_zero(rest));
                const std::uint32_t vertex = refinement_.vertex(t, static_cast<Local>(v));
                const float way = way_[v] = samples_.way[samples_.placed.rank(vertex)];
                second = std::max(second, std::min(longest, way));
                longest = std::max(longest, way);
            }
        }
        return longest + second > least;
    }

    /// Computes the positions of the vertices, and the original volume of a fine tetrahedron.
    void place(std::uint32_t t) {
        const std::size_t count = way_.size();
        position_.resize(count);
        for (std::size_t v = 0; v < count; ++v) {
            const auto local = static_cast<Local>(v);
            position_[v] = Vec3d(get_bit(moved_, local) != 0
                                     ? samples_.place[samples_.placed.rank(refinement_.vertex(t, local))]
                                     : refinement_.position(t, local));
        }
        volume_ = tetra_kernel::tetra_volume(tetra_kernel::get_corners(refinement_.coarse().positions.data(),
                                                                       refinement_.elements(t))) /
                  static_cast<double>(refinement_.pattern(t).tetra.size());
        placed_ = true;
    }

    const TetraRefinement& refinement_;
    const Samples& samples_;
    LocalBits moved_;
    std::vector<float> way_;
    std::vector<Vec3d> position_;
    bool placed_ = false;
    double volume_ = 0;
};

template <class Tetra>
std::vector<std::uint32_t> find_folds(const TetraRefinement& refinement, const Samples& samples,
                                      std::size_t count, const Tetra& tetra, const Context& ctx) {
    const auto look_at = [&](IndexRange range, const auto& mark) {
        if (ctx.stop.stop_requested()) return;
        FoldFinder finder(refinement, samples);
        for (std::size_t i = range.begin; i < range.end; ++i) finder.look_at(tetra(i), mark);
    };
    auto out = collect_marked(refinement.vertex_count(), count, 1024, look_at, ctx);
    ctx.throw_if_cancelled();
    return out;
}

}  // namespace

std::vector<std::uint32_t> find_folds(const TetraRefinement& refinement, const Samples& samples,
                                      const Context& ctx) {
    const auto all = [](std::size_t i) { return static_cast<std::uint32_t>(i); };
    return find_folds(refinement, samples, refinement.coarse().tetra.size(), all, ctx);
}

std::vector<std::uint32_t> find_folds(const TetraRefinement& refinement, const Samples& samples,
                                      std::span<const std::uint32_t> tetra, const Context& ctx) {
    const auto some = [&](std::size_t i) { return tetra[i]; };
    return find_folds(refinement, samples, tetra.size(), some, ctx);
}

}  // namespace coppice::tetra_internal
