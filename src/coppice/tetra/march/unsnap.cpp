#include <algorithm>

#include "coppice/base/parallel.h"
#include "coppice/base/sort.h"
#include "coppice/tetra/march/snapping_internal.h"

namespace coppice::tetra_internal {
namespace {

using Local = TetraPattern::Local;

/// Visits the fine tetrahedra around vertices.
class Star {
  public:
    Star(const TetraRefinement& refinement, const Samples& samples)
        : refinement_(refinement), samples_(samples), signs_(kKept) {
        kept_.fill(std::numeric_limits<std::uint32_t>::max());
    }

    Fan fan(std::uint32_t vertex) {
        segments_.clear();
        visit(vertex, [&](std::uint32_t t, Local local, const std::array<Local, 4>& fine) {
            const Cut& cut = kCuts[signs_[t % kKept].code(fine)];
            for (std::uint32_t i = 0; i < cut.size; ++i) {
                const std::uint8_t c = cut.corners[i];
                if (c < kCutVertex || fine[c - kCutVertex] != local) continue;
                // A cut polygon with a corner at a vertex is a triangle: one corner is inside and the others
                // are cut off.
                const std::uint64_t next = corner(t, fine, cut.corners[(i + 1) % 3]);
                const std::uint64_t last = corner(t, fine, cut.corners[(i + 2) % 3]);
                segments_.push_back(refinement_.mirrored(t) ? Segment{last, next} : Segment{next, last});
            }
        });
        return judge_fan<std::uint64_t>(segments_);
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
    /// Calls use(tetrahedron, local vertex, vertices) for the fine tetrahedra that contain a vertex, in
    /// coarse ones with vertices on both sides; their signs are available in the call.
    template <class Use>
    void visit(std::uint32_t vertex, const Use& use) {
        const auto place = refinement_.place(vertex);
        for (const std::uint32_t t : refinement_.around(place.kind, place.part)) {
            if (!gather(t)) continue;
            const TetraPattern& pattern = refinement_.pattern(t);
            const std::uint32_t group = refinement_.group_in(t, place.kind, place.part);
            const auto local = static_cast<Local>(pattern.first_vertex[group] + place.index);
            for (const Local fine : pattern.tetra_around(local)) use(t, local, pattern.tetra[fine]);
        }
    }

    /// Caches the signs of a coarse tetrahedron; returns false if they are all equal. Consecutive vertices
    /// share most tetrahedra.
    bool gather(std::uint32_t t) {
        const std::size_t slot = t % kKept;
        if (kept_[slot] != t) {
            kept_[slot] = t;
            mixed_[slot] = signs_[slot].gather(refinement_, samples_, t);
        }
        return mixed_[slot];
    }

    static constexpr std::size_t kKept = 16;
    using Segment = LinkSegment<std::uint64_t>;

    std::uint64_t corner(std::uint32_t t, const std::array<Local, 4>& fine, std::uint8_t c) const {
        if (c >= kCutVertex) {
            const std::uint64_t v = refinement_.vertex(t, fine[c - kCutVertex]);
            return v << 32 | v;
        }
        const std::uint64_t a = refinement_.vertex(t, fine[kTetraEdges[c][0]]);
        const std::uint64_t b = refinement_.vertex(t, fine[kTetraEdges[c][1]]);
        return std::min(a, b) << 32 | std::max(a, b);
    }

    const TetraRefinement& refinement_;
    const Samples& samples_;
    std::vector<LocalSigns> signs_;  ///< of recently used tetrahedra, at their number modulo the size
    std::array<std::uint32_t, kKept> kept_;
    std::array<bool, kKept> mixed_{};
    std::vector<Segment> segments_;
};

void put_back(std::span<const std::uint32_t> vertices, Samples& samples) {
    for (const std::uint32_t v : vertices) samples.put_back(v);
}

constexpr std::size_t kUnsnapGrain = 256;

/// Returns the coarse tetrahedra that contain one of the vertices, ascending.
std::vector<std::uint32_t> tetra_around(const TetraRefinement& refinement,
                                        std::span<const std::uint32_t> vertices, const Context& ctx) {
    const auto visit = [&](IndexRange range, const auto& mark) {
        for (std::size_t i = range.begin; i < range.end; ++i) {
            const auto place = refinement.place(vertices[i]);
            std::ranges::for_each(refinement.around(place.kind, place.part), mark);
        }
    };
    return collect_marked(refinement.coarse().tetra.size(), vertices.size(), kUnsnapGrain, visit, ctx);
}

std::vector<std::uint32_t> neighbours_on(const TetraRefinement& refinement, const Samples& samples,
                                         std::span<const std::uint32_t> vertices, const Context& ctx) {
    const auto visit = [&](IndexRange range, const auto& mark) {
        Star star(refinement, samples);
        for (std::size_t i = range.begin; i < range.end; ++i) star.for_each_neighbour_on(vertices[i], mark);
    };
    return collect_marked(refinement.vertex_count(), vertices.size(), kUnsnapGrain, visit, ctx);
}

/// Moves these vertices back, and further ones until no tetrahedron is inverted.
void unfold(const TetraRefinement& refinement, Samples& samples, std::vector<std::uint32_t> folds,
            const Context& ctx) {
    while (!folds.empty()) {
        put_back(folds, samples);
        folds = find_folds(refinement, samples, tetra_around(refinement, folds, ctx), ctx);
    }
}

/// The vertices that are kept, and the changes.
struct Settled {
    std::vector<std::uint8_t> used;  ///< see SnappedVertices
    std::vector<std::uint32_t>
        changed;  ///< coarse tetrahedra around vertices that were moved back, ascending
};

/// Determines unknown fans, and moves vertices back until every fan is single or none.
Settled settle_fans(const TetraRefinement& refinement, Samples& samples, std::vector<Fan> fans,
                    const Context& ctx) {
    Settled out;
    std::vector<std::uint32_t> open, unsnapped, folds;
    std::uint32_t rank = 0;
    for_each_bit(samples.placed.words(), [&](std::uint32_t v) {
        if (fans[rank++] == Fan::unknown) open.push_back(v);
    });
    while (true) {
        parallel_for_ranges(ctx, open.size(), kUnsnapGrain, [&](IndexRange r) {
            Star star(refinement, samples);
            for (std::size_t i = r.begin; i < r.end; ++i)
                fans[samples.placed.rank(open[i])] = star.fan(open[i]);
        });
        ctx.throw_if_cancelled();
        unsnapped = std::move(folds);
        for (const std::uint32_t v : open) {
            if (fans[samples.placed.rank(v)] == Fan::non_manifold) unsnapped.push_back(v);
        }
        if (unsnapped.empty()) break;
        sort_unique(unsnapped);
        put_back(unsnapped, samples);
        // Vertices that are moved back can only change the fans of their neighbours, and invert tetrahedra
        // around them.
        for (const std::uint32_t v : unsnapped) fans[samples.placed.rank(v)] = Fan::none;
        open = neighbours_on(refinement, samples, unsnapped, ctx);
        const std::vector<std::uint32_t> tetra = tetra_around(refinement, unsnapped, ctx);
        out.changed.insert(out.changed.end(), tetra.begin(), tetra.end());
        folds = find_folds(refinement, samples, tetra, ctx);
    }
    sort_unique(out.changed);
    out.used.resize(fans.size());
    std::ranges::transform(fans, out.used.begin(), [](Fan fan) { return fan == Fan::single; });
    return out;
}

}  // namespace

SnappedVertices unsnap_vertices(const TetraRefinement& refinement, Samples& samples, const Context& ctx) {
    unfold(refinement, samples, find_folds(refinement, samples, ctx), ctx);
    SnappedVertices out{CrossedTetra(refinement, samples, ctx), {}};
    ctx.throw_if_cancelled();
    Settled settled = settle_fans(refinement, samples, find_fans(refinement, samples, out.crossed, ctx), ctx);
    out.crossed.update(settled.changed, ctx);
    out.used = std::move(settled.used);
    return out;
}

}  // namespace coppice::tetra_internal
