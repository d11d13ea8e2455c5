#include <algorithm>

#include "coppice/base/parallel.h"
#include "coppice/tetra/march_internal.h"

namespace coppice::march_detail {
namespace {

using Local = TetraPattern::Local;

/// Two corners of a triangle that follow a vertex on the surface. A corner is named by the two fine vertices
/// of its edge, or twice by the one that it is.
struct LinkSegment {
    std::uint64_t from, to;
    friend auto operator<=>(const LinkSegment&, const LinkSegment&) = default;
};

enum class Fan : std::uint8_t { none, single, spoilt };

/// Looks at the fine tetrahedra around one vertex after the other.
class Star {
  public:
    Star(const TetraRefinement& refinement, const Samples& samples)
        : refinement_(refinement), samples_(samples), signs_(kKept) {
        kept_.fill(std::numeric_limits<std::uint32_t>::max());
    }

    Fan fan(std::uint32_t vertex) {
        if (folds(vertex)) return Fan::spoilt;
        segments_.clear();
        visit(vertex, [&](std::uint32_t t, Local local, const std::array<Local, 4>& fine) {
            const Cut& cut = signs_[t % kKept].cut(fine);
            for (std::uint32_t i = 0; i < cut.size; ++i) {
                const std::uint8_t c = cut.corners[i];
                if (c < kCutVertex || fine[c - kCutVertex] != local) continue;
                // A cut with a corner in a vertex has three corners: one inside and the others are cut off.
                const std::uint64_t next = corner(t, fine, cut.corners[(i + 1) % 3]);
                const std::uint64_t last = corner(t, fine, cut.corners[(i + 2) % 3]);
                segments_.push_back(refinement_.mirrored(t) ? LinkSegment{last, next}
                                                            : LinkSegment{next, last});
            }
        });
        return judge();
    }

    /// Calls use(number) for the vertices on the surface that share a fine tetrahedron with this one.
    template <class Use>
    void for_each_neighbour_on(std::uint32_t vertex, const Use& use) {
        visit(vertex, [&](std::uint32_t t, Local, const std::array<Local, 4>& fine) {
            for (const Local other : fine) {
                const std::uint32_t v = refinement_.vertex(t, other);
                if (v != vertex && samples_.on.test(v)) use(v);
            }
        });
    }

  private:
    /// Calls use(tetrahedron) for the coarse ones that have a vertex.
    template <class Use>
    void visit_coarse(const TetraRefinement::Place& place, const Use& use) const {
        if (place.kind == TetraRefinement::Kind::inside) {
            use(place.part);
        } else {
            for (const std::uint32_t t : refinement_.around(place.kind, place.part)) use(t);
        }
    }

    /// Calls use(tetrahedron, vertex there, vertices) for the fine ones that have a vertex.
    template <class Use>
    void visit_fine(const TetraRefinement::Place& place, std::uint32_t t, const Use& use) const {
        const TetraPattern& pattern = refinement_.pattern(t);
        const std::uint32_t group = refinement_.group_in(t, place.kind, place.part);
        const auto local = static_cast<Local>(pattern.first_vertex[group] + place.index);
        for (const Local fine : pattern.tetra_around(local)) use(local, pattern.tetra[fine]);
    }

    /// The same for those where some are inside and some are not, with their signs at hand.
    template <class Use>
    void visit(std::uint32_t vertex, const Use& use) {
        const auto place = refinement_.place(vertex);
        visit_coarse(place, [&](std::uint32_t t) {
            if (!gather(t)) return;
            visit_fine(place, t, [&](Local local, const auto& fine) { use(t, local, fine); });
        });
    }

    /// Has the signs of a coarse tetrahedron in their place; false when they are all alike. Vertices that
    /// follow each other share most of theirs.
    bool gather(std::uint32_t t) {
        const std::size_t slot = t % kKept;
        if (kept_[slot] != t) {
            kept_[slot] = t;
            mixed_[slot] = signs_[slot].gather(refinement_, samples_, t);
        }
        return mixed_[slot];
    }

    /// Whether a vertex is the one that moved most in a fine tetrahedron that has become too flat.
    bool folds(std::uint32_t vertex) const {
        const auto place = refinement_.place(vertex);
        const float way = samples_.way[samples_.placed.rank(vertex)];
        bool found = false;
        visit_coarse(place, [&](std::uint32_t t) {
            if (found || 2 * way <= kWidthShare * refinement_.width(t)) return;
            visit_fine(place, t, [&](Local local, const std::array<Local, 4>& fine) {
                found = found || (may_be_flat(t, local, vertex, way, fine) && is_flat(t, fine));
            });
        });
        return found;
    }

    /// False when the vertex is not the one that moved most (of equals, the first), and when the two that
    /// moved most did not move farther than the tetrahedron is wide: then it cannot have turned over.
    bool may_be_flat(std::uint32_t t, Local local, std::uint32_t vertex, float way,
                     const std::array<Local, 4>& fine) const {
        float second = 0;
        for (const Local other : fine) {
            if (other == local) continue;
            const std::uint32_t v = refinement_.vertex(t, other);
            if (!samples_.on.test(v)) continue;
            const float its_way = samples_.way[samples_.placed.rank(v)];
            if (its_way > way || (its_way == way && v < vertex)) return false;
            second = std::max(second, its_way);
        }
        return way + second > kWidthShare * refinement_.width(t);
    }

    bool is_flat(std::uint32_t t, const std::array<Local, 4>& fine) const {
        constexpr double kLeastVolume = 0.15;
        std::array<Vec3d, 4> from, to;
        for (std::size_t i = 0; i < 4; ++i) {
            const std::uint32_t v = refinement_.vertex(t, fine[i]);
            from[i] = to[i] = Vec3d(refinement_.position(t, fine[i]));
            if (samples_.on.test(v)) to[i] = Vec3d(samples_.place[samples_.placed.rank(v)]);
        }
        const auto volume = [](const std::array<Vec3d, 4>& p) {
            return dot(cross(p[1] - p[0], p[2] - p[0]), p[3] - p[0]);
        };
        // Both may be negative: the order of the vertices is the pattern's.
        return !(volume(to) / volume(from) > kLeastVolume);
    }

    static constexpr float kWidthShare = 0.94f;
    static constexpr std::size_t kKept = 16;

    std::uint64_t corner(std::uint32_t t, const std::array<Local, 4>& fine, std::uint8_t c) const {
        if (c >= kCutVertex) {
            const std::uint64_t v = refinement_.vertex(t, fine[c - kCutVertex]);
            return v << 32 | v;
        }
        const std::uint64_t a = refinement_.vertex(t, fine[kTetraEdges[c][0]]);
        const std::uint64_t b = refinement_.vertex(t, fine[kTetraEdges[c][1]]);
        return std::min(a, b) << 32 | std::max(a, b);
    }

    /// The segments are one closed way of at least three that comes to no corner twice.
    Fan judge() {
        if (segments_.empty()) return Fan::none;
        std::ranges::sort(segments_);
        for (std::size_t i = 1; i < segments_.size(); ++i) {
            if (segments_[i].from == segments_[i - 1].from) return Fan::spoilt;
        }
        std::size_t at = 0, steps = 0;
        do {
            const auto next = std::ranges::lower_bound(segments_, segments_[at].to, {}, &LinkSegment::from);
            if (next == segments_.end() || next->from != segments_[at].to) return Fan::spoilt;
            at = static_cast<std::size_t>(next - segments_.begin());
            ++steps;
        } while (at != 0 && steps <= segments_.size());
        return steps == segments_.size() && steps >= 3 ? Fan::single : Fan::spoilt;
    }

    const TetraRefinement& refinement_;
    const Samples& samples_;
    std::vector<LocalSigns> signs_;  ///< of the tetrahedra last asked for, each in the place of its number
    std::array<std::uint32_t, kKept> kept_;
    std::array<bool, kKept> mixed_{};
    std::vector<LinkSegment> segments_;
};

std::vector<std::uint32_t> set_bits(const RankedBits& bits) {
    std::vector<std::uint32_t> out;
    const auto words = bits.words();
    for (std::size_t w = 0; w < words.size(); ++w) {
        for (std::uint64_t rest = words[w]; rest != 0; rest &= rest - 1)
            out.push_back(static_cast<std::uint32_t>(64 * w) +
                          static_cast<std::uint32_t>(std::countr_zero(rest)));
    }
    return out;
}

}  // namespace

std::vector<std::uint8_t> free_vertices(const TetraRefinement& refinement, Samples& samples,
                                        const Context& ctx) {
    constexpr std::size_t kGrain = 256;
    std::vector<Fan> fans(samples.place.size());
    std::vector<std::uint32_t> open = set_bits(samples.on);
    while (!open.empty()) {
        ctx.throw_if_cancelled();
        parallel_for_ranges(ctx, open.size(), kGrain, [&](IndexRange r) {
            Star star(refinement, samples);
            for (std::size_t i = r.begin; i < r.end; ++i)
                fans[samples.placed.rank(open[i])] = star.fan(open[i]);
        });
        std::vector<std::uint32_t> freed;
        for (const std::uint32_t v : open) {
            if (fans[samples.placed.rank(v)] == Fan::spoilt) freed.push_back(v);
        }
        for (const std::uint32_t v : freed) {
            samples.on.reset(v);
            if (samples.height[v] > 0) samples.inside.set(v);
        }
        open.clear();
        Star star(refinement, samples);
        for (const std::uint32_t v : freed)
            star.for_each_neighbour_on(v, [&](std::uint32_t w) { open.push_back(w); });
        std::ranges::sort(open);
        open.erase(std::unique(open.begin(), open.end()), open.end());
    }
    std::vector<std::uint8_t> used(fans.size());
    std::ranges::transform(fans, used.begin(), [](Fan f) { return f == Fan::single; });
    return used;
}

}  // namespace coppice::march_detail
