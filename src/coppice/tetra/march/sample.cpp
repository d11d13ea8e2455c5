#include <algorithm>
#include <utility>

#include "coppice/base/parallel.h"
#include "coppice/base/segment_distance.h"
#include "coppice/tetra/march/cuts_internal.h"

namespace coppice::tetra_internal {
namespace {

using Local = TetraPattern::Local;

constexpr float kHeldReach = 0.45f;  // [fine edges] how far a held vertex may be moved

/// A vertex that is to be moved, and where.
struct Target {
    std::uint32_t vertex;
    Vec3 position;
    float way;
};

/// A held vertex that the field puts outside or near to the surface.
struct Weak {
    std::uint32_t vertex, region;
    Vec3 position;
    float reach;       ///< [m] how far it may be moved
    float radius = 0;  ///< [m] of the axis
    float away = 0;    ///< [m] from the axis
    float height = 0;  ///< where it would be moved to
};

/// What one range of regions finds.
struct Found {
    std::vector<Target> targets;
    std::vector<Weak> weak;
};

/// Samples the vertices of one region after the other.
class RegionSampler {
  public:
    RegionSampler(const TetraRefinement& refinement, FieldRef field, float snap, Samples& out, Found& found)
        : refinement_(refinement),
          field_(field),
          profile_(field.level()),
          snap_(snap),
          out_(out),
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
        // How far they may be moved: those on the hull stay.
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
            out_.height[vertex_[i]] = height;
            Vec3 step;
            const bool is_near = step_to_surface(samples_[i], height, snap_ * edge_[i], step);
            if (out_.held.test(vertex_[i])) {
                if (is_near || height <= 0)
                    found_.weak.push_back({vertex_[i], region_, points_[i], kHeldReach * edge_[i]});
                continue;
            }
            if (!is_near) continue;
            near_[near] = static_cast<std::uint32_t>(i);
            target_[near++] = points_[i] + step;
        }
        if (near > 0) find_targets(near);
        size_ = 0;
    }

    /// Newton's step along the gradient; false when it is longer than `most`.
    bool step_to_surface(const FieldSample& s, float height, float most, Vec3& step) const {
        const float slope = profile_.slope(s.value);
        const Vec3 gradient = s.gradient * slope;
        const float squared = length_squared(gradient);
        if (!(height * height <= most * most * squared) || !(squared > 0) || most <= 0) return false;
        step = gradient * (-height / squared);
        return is_finite(step);
    }

    /// A second step, from where the first one led, decides: it must be the shorter one.
    void find_targets(std::size_t near) {
        field_.sample(region_, std::span(target_.data(), near), std::span(samples_.data(), near));
        for (std::size_t k = 0; k < near; ++k) {
            const std::uint32_t i = near_[k];
            const float reach = snap_ * edge_[i];
            const float first = distance(target_[k], points_[i]);
            Vec3 step;
            const float height = profile_.height(samples_[k].value);
            if (!step_to_surface(samples_[k], height, std::max(0.5f * first, 0.02f * reach), step)) continue;
            const Vec3 end = target_[k] + step;
            const float way = distance(end, points_[i]);
            if (way <= reach) found_.targets.push_back({vertex_[i], end, way});
        }
    }

    const TetraRefinement& refinement_;
    FieldRef field_;
    Profile profile_;
    float snap_;
    Samples& out_;
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

/// On the way from a weak vertex to the nearest point of the axis it holds. Notes its radius.
Vec3 towards_axis(Weak& weak, const HeldVertices& held, std::span<const Segment> axes) {
    const auto named = std::ranges::lower_bound(held.list, weak.vertex, {}, &HeldVertex::vertex);
    const Segment& s = axes[named->segment];
    const Vec3d a(s.a), along = Vec3d(s.b) - a, from(weak.position);
    const double t = closest_parameter(from, a, along);
    weak.radius = s.radius_a + static_cast<float>(t) * (s.radius_b - s.radius_a);
    const Vec3d way = a + along * t - from;
    const double whole = length(way);
    weak.away = static_cast<float>(whole);
    return Vec3(from + way * (whole > weak.reach ? weak.reach / whole : 1));
}

/// Moves weak vertices, each on the way to the nearest point of the axis it holds, unless the field is less
/// there.
void move_weak(FieldRef field, const HeldVertices& held, std::span<const Segment> axes,
               const Samples& samples, Found& found) {
    const Profile profile(field.level());
    std::vector<Vec3> places;
    std::vector<FieldSample> there;
    for (std::size_t begin = 0, end = 0; begin < found.weak.size(); begin = end) {
        const std::uint32_t region = found.weak[begin].region;
        places.clear();
        for (; end < found.weak.size() && found.weak[end].region == region; ++end)
            places.push_back(towards_axis(found.weak[end], held, axes));
        there.resize(places.size());
        field.sample(region, places, there);
        for (std::size_t i = begin; i < end; ++i) {
            Weak& w = found.weak[i];
            const Vec3 place = places[i - begin];
            w.height = profile.height(there[i - begin].value);
            const float way = distance(place, w.position);
            if (way > 0 && w.height >= samples.height[w.vertex])
                found.targets.push_back({w.vertex, place, way});
        }
    }
}

}  // namespace

Samples sample_vertices(const TetraRefinement& refinement, FieldRef field, float snap,
                        const HeldVertices& held, std::span<const Segment> axes, const Context& ctx) {
    constexpr std::size_t kRegions = 16;
    const std::size_t count = refinement.vertex_count(), regions = refinement.coarse().region_count();
    Samples out{
        {}, RankedBits(count), held.bits, RankedBits(count), RankedBits(count), RankedBits(count), {}, {},
        {}};
    out.height.resize(count);
    // Vertices of no tetrahedron, which nobody samples.
    std::fill_n(out.height.begin(), refinement.coarse().positions.size(), -1.0f);
    std::vector<Found> found((regions + kRegions - 1) / kRegions);
    parallel_for_ranges(ctx, regions, kRegions, [&](IndexRange r) {
        if (ctx.stop.stop_requested()) return;
        RegionSampler sampler(refinement, field, snap, out, found[r.begin / kRegions]);
        for (std::size_t region = r.begin; region < r.end; ++region)
            sampler.sample(static_cast<std::uint32_t>(region));
    });
    ctx.throw_if_cancelled();

    parallel_for(ctx, found.size(), 1, [&](std::size_t i) { move_weak(field, held, axes, out, found[i]); });
    for (const Found& part : found) {
        for (const Target& t : part.targets) out.placed.set(t.vertex);
        for (const Weak& w : part.weak) out.weak.push_back({w.vertex, w.radius, w.away, w.height});
    }
    std::ranges::sort(out.weak, {}, &WeakVertex::vertex);
    out.place.resize(out.placed.count());
    out.way.resize(out.place.size());
    parallel_for(ctx, found.size(), 16, [&](std::size_t i) {
        for (const Target& t : found[i].targets) {
            const std::uint32_t rank = out.placed.rank(t.vertex);
            out.place[rank] = t.position;
            out.way[rank] = t.way;
        }
    });
    out.moved = out.placed;
    const auto inside = out.inside.words(), on = out.on.words();
    const auto is_held = held.bits.words(), placed = std::as_const(out.placed).words();
    parallel_for(ctx, inside.size(), 4096, [&](std::size_t w) {
        std::uint64_t bits = 0;
        for (std::size_t i = 64 * w; i < std::min(count, 64 * w + 64); ++i)
            bits |= std::uint64_t{out.height[i] > 0} << (i % 64);
        on[w] = placed[w] & ~is_held[w];
        inside[w] = (bits & ~on[w]) | is_held[w];
    });
    return out;
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
            const std::uint32_t vertex = refinement.parts(t)[corner];
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
