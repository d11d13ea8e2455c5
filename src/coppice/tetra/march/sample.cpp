#include <algorithm>
#include <atomic>
#include <utility>

#include "coppice/base/parallel.h"
#include "coppice/tetra/march/cuts_internal.h"
#include "coppice/tetra/march/kernel/snap_kernel.h"

namespace coppice::tetra_internal {
namespace {

using Local = TetraPattern::Local;

/// A fine vertex with a target position.
struct MovedVertex {
    std::uint32_t vertex;  ///< fine
    Vec3 position;         ///< [m] target
    float way;             ///< [m] distance
};

/// A held vertex that is outside or near the surface according to the field.
struct ShallowVertex {
    std::uint32_t vertex;  ///< fine
    std::uint32_t region;  ///< of a tetrahedron that contains it
    Vec3 position;         ///< [m]
    float reach;           ///< [m] maximum distance that it may move
    float height;          ///< of the profile
};

/// Results of sampling.
struct SampledVertices {
    /// Vertices that need special treatment.
    struct Found {
        std::vector<MovedVertex> near;       ///< not held, with their positions on the surface
        std::vector<ShallowVertex> shallow;  ///< held; sorted by region
    };
    /// Height of the profile at every fine vertex; -1 for vertices without tetrahedra.
    Buffer<float> height;
    std::vector<std::uint64_t> above;  ///< a bit for each vertex with a height above 0
    std::vector<Found> found;          ///< in chunks, in any order
};
using Found = SampledVertices::Found;

/// A shallow vertex relative to the axis that it holds.
struct Weak {
    float radius = 0;  ///< [m] radius of the axis
    float away = 0;    ///< [m] distance from the axis
    float height = 0;  ///< height at its target
};

/// Samples the vertices of regions.
class RegionSampler {
  public:
    RegionSampler(const TetraRefinement& refinement, FieldRef field, float snap, tetra_kernel::BitsView held,
                  std::span<float> height, Found& found)
        : refinement_(refinement),
          field_(field),
          profile_(field.level()),
          snap_(snap),
          held_(held),
          height_(height),
          found_(found) {}

    void sample(std::uint32_t region) {
        const TetraMesh& mesh = refinement_.coarse();
        region_ = region;
        for (std::uint32_t t = mesh.first[region]; t < mesh.first[region + 1]; ++t) {
            const std::uint32_t owned = refinement_.owned(t);
            for (std::uint32_t g = 0; g < TetraPattern::kGroups; ++g) {
                if ((owned >> g & 1) != 0) add_group(t, g);
            }
        }
        flush();
    }

  private:
    void add_group(std::uint32_t tetra, std::uint32_t group) {
        const auto& first = refinement_.pattern(tetra).first_vertex;
        if (first[group] == first[group + 1]) return;
        const std::uint32_t vertex = refinement_.first_vertex(tetra, group);
        // Maximum distance that they may move: vertices on the hull stay.
        const float edge = refinement_.shortest_edge(tetra, group);
        for (std::uint32_t v = first[group]; v < first[group + 1]; ++v) {
            points_[size_] = refinement_.position(tetra, static_cast<Local>(v));
            vertex_[size_] = vertex + (v - first[group]);
            edge_[size_] = edge;
            if (++size_ == kBatch) flush();
        }
    }

    void flush() {
        const std::span<const Vec3> points(points_.data(), size_);
        field_.sample(region_, points, std::span(samples_.data(), size_));
        std::size_t near = 0;
        for (std::size_t i = 0; i < size_; ++i) {
            const float height = profile_.height(samples_[i].value);
            height_[vertex_[i]] = height;
            Vec3 step;
            const bool is_near =
                tetra_kernel::step_to_surface(profile_, samples_[i], height, snap_ * edge_[i], step);
            if (held_.test(vertex_[i])) {
                if (is_near || height <= 0)
                    found_.shallow.push_back(
                        {vertex_[i], region_, points_[i], tetra_kernel::kHeldReach * edge_[i], height});
                continue;
            }
            if (!is_near) continue;
            near_[near] = static_cast<std::uint32_t>(i);
            target_[near++] = points_[i] + step;
        }
        if (near > 0) find_targets(near);
        size_ = 0;
    }

    void find_targets(std::size_t near) {
        field_.sample(region_, std::span(target_.data(), near), std::span(samples_.data(), near));
        for (std::size_t k = 0; k < near; ++k) {
            const std::uint32_t i = near_[k];
            tetra_kernel::SnapPlace place;
            if (tetra_kernel::second_step(profile_, samples_[k], points_[i], target_[k], snap_ * edge_[i],
                                          place))
                found_.near.push_back({vertex_[i], place.position, place.way});
        }
    }

    const TetraRefinement& refinement_;
    FieldRef field_;
    Profile profile_;
    float snap_;
    tetra_kernel::BitsView held_;
    std::span<float> height_;
    Found& found_;
    std::uint32_t region_ = 0;
    std::size_t size_ = 0;
    std::array<Vec3, kBatch> points_;
    std::array<std::uint32_t, kBatch> vertex_;
    std::array<float, kBatch> edge_;
    std::array<FieldSample, kBatch> samples_;
    std::array<std::uint32_t, kBatch> near_;
    std::array<Vec3, kBatch> target_;
};

/// Returns the target of a shallow vertex towards the closest point of the axis that it holds. Stores the
/// radius and distance in `weak`.
Vec3 towards_axis(const ShallowVertex& vertex, const HeldVertices& held, std::span<const Segment> axes,
                  Weak& weak) {
    const auto named = std::ranges::lower_bound(held.list, vertex.vertex, {}, &HeldVertex::vertex);
    const auto step = tetra_kernel::step_to_axis(axes[named->segment], vertex.position, vertex.reach);
    weak.radius = step.radius;
    weak.away = step.away;
    return step.position;
}

/// Moves shallow vertices towards the closest point of the axis that they hold, unless the field is smaller
/// there.
std::vector<Weak> move_shallow(FieldRef field, const HeldVertices& held, std::span<const Segment> axes,
                               Found& found) {
    const Profile profile(field.level());
    std::vector<Weak> weak(found.shallow.size());
    std::vector<Vec3> places;
    std::vector<FieldSample> there;
    for (std::size_t begin = 0, end = 0; begin < weak.size(); begin = end) {
        const std::uint32_t region = found.shallow[begin].region;
        places.clear();
        for (; end < weak.size() && found.shallow[end].region == region; ++end)
            places.push_back(towards_axis(found.shallow[end], held, axes, weak[end]));
        there.resize(places.size());
        field.sample(region, places, there);
        for (std::size_t i = begin; i < end; ++i) {
            const ShallowVertex& v = found.shallow[i];
            const Vec3 place = places[i - begin];
            weak[i].height = profile.height(there[i - begin].value);
            const float way = distance(place, v.position);
            if (way > 0 && weak[i].height >= v.height) found.near.push_back({v.vertex, place, way});
        }
    }
    return weak;
}

/// Calls use(vertex) for all vertices with a target, in parallel.
template <class Use>
void for_each_moved(std::span<const Found> found, const Context& ctx, const Use& use) {
    constexpr std::size_t kMax = 4096;
    std::vector<std::span<const MovedVertex>> chunks;
    for (const Found& f : found) {
        for (std::size_t i = 0; i < f.near.size(); i += kMax)
            chunks.push_back(std::span(f.near).subspan(i, std::min(kMax, f.near.size() - i)));
    }
    parallel_for(ctx, chunks.size(), 16, [&](std::size_t i) { std::ranges::for_each(chunks[i], use); });
}

/// Samples all fine vertices.
SampledVertices sample_fine(const TetraRefinement& refinement, FieldRef field, float snap,
                            tetra_kernel::BitsView held, const Context& ctx) {
    constexpr std::size_t kRegions = 16;
    const std::size_t regions = refinement.coarse().region_count();
    SampledVertices out;
    out.height.resize(refinement.vertex_count());
    // Vertices without tetrahedra are not sampled.
    std::fill_n(out.height.begin(), refinement.coarse().positions.size(), -1.0f);
    out.found.resize((regions + kRegions - 1) / kRegions);
    parallel_for_ranges(ctx, regions, kRegions, [&](IndexRange r) {
        if (ctx.stop.stop_requested()) return;
        RegionSampler sampler(refinement, field, snap, held, out.height, out.found[r.begin / kRegions]);
        for (std::size_t region = r.begin; region < r.end; ++region)
            sampler.sample(static_cast<std::uint32_t>(region));
    });
    ctx.throw_if_cancelled();
    out.above.resize(out.height.size() / 64 + 1);
    parallel_for(ctx, out.above.size(), 4096, [&](std::size_t w) {
        std::uint64_t bits = 0;
        for (std::size_t i = 64 * w; i < std::min(out.height.size(), 64 * w + 64); ++i)
            bits |= std::uint64_t{out.height[i] > 0} << (i % 64);
        out.above[w] = bits;
    });
    return out;
}

/// Moves held vertices, and stores the sides of all vertices.
Samples settle_samples(const TetraRefinement& refinement, FieldRef field, SampledVertices sampled,
                       const HeldVertices& held, std::span<const Segment> axes, const Context& ctx) {
    const std::size_t count = refinement.vertex_count();
    Samples out{std::move(sampled.height),
                RankedBits(count, std::move(sampled.above)),
                RankedBits(count),
                held.bits,
                RankedBits(count),
                RankedBits(count),
                RankedBits(count),
                {},
                {},
                {}};
    std::vector<Found>& found = sampled.found;
    std::vector<std::vector<Weak>> weak(found.size());
    parallel_for(ctx, found.size(), 1,
                 [&](std::size_t i) { weak[i] = move_shallow(field, held, axes, found[i]); });
    for (std::size_t i = 0; i < found.size(); ++i) {
        for (std::size_t k = 0; k < weak[i].size(); ++k) {
            const Weak& w = weak[i][k];
            out.weak.push_back({found[i].shallow[k].vertex, w.radius, w.away, w.height});
        }
    }
    std::ranges::sort(out.weak, {}, &WeakVertex::vertex);
    for_each_moved(found, ctx, [&, words = out.placed.words()](const MovedVertex& v) {
        std::atomic_ref(words[v.vertex / 64])
            .fetch_or(std::uint64_t{1} << (v.vertex % 64), std::memory_order_relaxed);
    });
    out.place.resize(out.placed.count());
    out.way.resize(out.place.size());
    for_each_moved(found, ctx, [&](const MovedVertex& v) {
        const std::uint32_t rank = out.placed.rank(v.vertex);
        out.place[rank] = v.position;
        out.way[rank] = v.way;
    });
    out.moved = out.placed;
    const auto inside = out.inside.words(), on = out.on.words();
    const auto is_held = held.bits.words(), placed = std::as_const(out.placed).words();
    const auto above = std::as_const(out.above).words();
    parallel_for(ctx, inside.size(), 4096, [&](std::size_t w) {
        on[w] = placed[w] & ~is_held[w];
        inside[w] = (above[w] & ~on[w]) | is_held[w];
    });
    return out;
}

}  // namespace

Samples sample_vertices(const TetraRefinement& refinement, FieldRef field, float snap,
                        const HeldVertices& held, std::span<const Segment> axes, const Context& ctx) {
    return settle_samples(refinement, field, sample_fine(refinement, field, snap, {held.bits.words()}, ctx),
                          held, axes, ctx);
}

std::vector<TetraFace> open_faces(const TetraRefinement& refinement, const RankedBits& inside,
                                  bool with_inner, const Context& ctx) {
    constexpr std::size_t kGrain = 4096;
    const std::size_t tetra = refinement.coarse().tetra.size();
    std::vector<std::vector<TetraFace>> found((tetra + kGrain - 1) / kGrain);
    const auto is_open = [&](std::uint32_t t, std::uint32_t opposite) {
        const TetraPattern& pattern = refinement.pattern(t);
        bool any = false, all = true;
        for (std::size_t v = 0; v < pattern.weights.size(); ++v) {
            if (pattern.weights[v][opposite] != 0) continue;
            const bool in = inside.test(refinement.vertex(t, static_cast<Local>(v)));
            any |= in;
            all &= in;
        }
        return any && (with_inner || !all);
    };
    parallel_for(ctx, tetra, kGrain, [&](std::size_t i) {
        const auto t = static_cast<std::uint32_t>(i);
        for (std::uint32_t corner = 0; corner < 4; ++corner) {
            if (!refinement.on_hull(t, 10 + corner) || !is_open(t, corner)) continue;
            const std::uint32_t vertex = refinement.elements(t)[corner];
            const auto& own = refinement.coarse().tetra[t];
            const auto opposite = static_cast<std::uint32_t>(std::ranges::find(own, vertex) - own.begin());
            found[i / kGrain].push_back({t, opposite});
        }
    });
    std::vector<TetraFace> out;
    for (const auto& part : found) out.insert(out.end(), part.begin(), part.end());
    const auto order = [](const TetraFace& a, const TetraFace& b) {
        return a.tetra != b.tetra ? a.tetra < b.tetra : a.opposite < b.opposite;
    };
    std::ranges::sort(out, order);
    return out;
}

}  // namespace coppice::tetra_internal
