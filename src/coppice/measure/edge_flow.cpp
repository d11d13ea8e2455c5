#include "coppice/measure/edge_flow.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <numbers>

#include "coppice/base/id.h"
#include "coppice/base/parallel.h"
#include "coppice/measure/forks_internal.h"

namespace coppice {
namespace {

constexpr std::size_t kEdgeFlowGrain = 1 << 13;

/// The loops of edges of a mesh.
class EdgeLoops {
  public:
    explicit EdgeLoops(const HalfEdges& edges) : edges_(edges), faces_(edges.vertex_count()) {
        for (std::uint32_t h = 0; h < edges.size(); ++h) ++faces_[edges.origin(h)];
    }

    /// Calls visit(vertices) once for each closed loop.
    template <class Visit>
    void for_each_closed(const Visit& visit) const {
        std::vector<char> seen(edges_.size());
        std::vector<std::uint32_t> loop;
        for (std::uint32_t first = 0; first < seen.size(); ++first) {
            if (seen[first] != 0 || edges_.twin(first) == kNoIndex) continue;
            loop.clear();
            std::uint32_t h = first;
            do {
                seen[h] = seen[edges_.twin(h)] = 1;
                loop.push_back(edges_.origin(h));
                h = straight_on(h);
            } while (h != kNoIndex && h != first && seen[h] == 0);
            if (h == first) visit(loop);
        }
    }

  private:
    // Returns the next half-edge straight across the end of one, if that vertex has four faces; kNoIndex
    // otherwise and at borders.
    std::uint32_t straight_on(std::uint32_t h) const {
        const std::uint32_t turn = edges_.next(h), across = edges_.twin(turn);
        if (faces_[edges_.origin(turn)] != 4 || across == kNoIndex) return kNoIndex;
        const std::uint32_t on = edges_.next(across);
        return edges_.twin(on) == kNoIndex ? kNoIndex : on;
    }

    const HalfEdges& edges_;
    std::vector<std::uint32_t> faces_;  // number of faces, by vertex
};

// Returns whether a closed polygon winds once around the axis of a cone, in either direction.
bool runs_round(const PolygonMesh& mesh, std::span<const std::uint32_t> loop, const RoundCone& cone) {
    const double size = length(cone.axis);
    if (!(size > 0)) return false;
    const Vec3d along = cone.axis / size;
    const auto across = [&](std::uint32_t v) {
        const Vec3d offset = Vec3d(mesh.positions[v]) - cone.a;
        return offset - along * dot(offset, along);
    };
    double angle = 0;
    Vec3d last = across(loop.back());
    for (const std::uint32_t v : loop) {
        const Vec3d now = across(v);
        angle += std::atan2(dot(cross(last, now), along), dot(last, now));
        last = now;
    }
    return std::abs(std::abs(angle) - 2 * std::numbers::pi) < 1;
}

std::vector<char> vertices_on_rings(const PolygonMesh& mesh, const EdgeLoops& loops,
                                    const CapsuleTree& capsules, const VertexPlaces& places) {
    std::vector<char> on_ring(mesh.positions.size());
    loops.for_each_closed([&](std::span<const std::uint32_t> loop) {
        const auto regular = std::find_if(loop.begin(), loop.end(),
                                          [&](std::uint32_t v) { return places.is_regular[v] != 0; });
        if (regular == loop.end()) return;
        if (!runs_round(mesh, loop, capsules.cone(places.nearest[*regular].capsule))) return;
        for (const std::uint32_t v : loop) on_ring[v] = 1;
    });
    return on_ring;
}

/// Radius classes, each half of the previous one.
class RadiusClasses {
  public:
    explicit RadiusClasses(const CapsuleTree& capsules) {
        for (std::uint32_t c = 0; c < capsules.size(); ++c)
            maximum_ = std::max({maximum_, capsules.cone(c).radius_a, capsules.cone(c).radius_b()});
    }
    /// Returns the class of a radius; the last class also contains all smaller ones.
    std::size_t of(double radius) const {
        if (!(radius > 0)) return kClasses - 1;
        return std::min(kClasses - 1, static_cast<std::size_t>(std::max(0.0, std::log2(maximum_ / radius))));
    }
    double maximum(std::size_t i) const { return std::ldexp(maximum_, -static_cast<int>(i)); }

    static constexpr std::size_t kClasses = 24;

  private:
    double maximum_ = 0;
};

std::vector<DensityClass> density(const PolygonMesh& mesh, const CapsuleTree& capsules,
                                  const VertexPlaces& places) {
    constexpr int kPieces = 8;  // number of sections per segment, each of one radius
    const RadiusClasses classes(capsules);
    std::vector<DensityClass> out(RadiusClasses::kClasses);
    for (std::uint32_t c = 0; c < capsules.size(); ++c) {
        const RoundCone& cone = capsules.cone(c);
        for (int k = 0; k < kPieces; ++k) {
            const double radius = cone.radius((k + 0.5) / kPieces);
            if (radius > 0) out[classes.of(radius)].length += length(cone.axis) / kPieces / radius;
        }
    }
    std::uint64_t all = 0;
    for (std::size_t v = 0; v < mesh.positions.size(); ++v) {
        const std::uint32_t c = places.nearest[v].capsule;
        if (c == kNoIndex) continue;
        ++all;
        ++out[classes.of(capsules.cone(c).closest_point(Vec3d(mesh.positions[v])).radius)].vertices;
    }
    for (std::size_t i = 0; i < out.size(); ++i) {
        out[i].radius = classes.maximum(i);
        out[i].percent =
            all > 0 ? 100.0 * static_cast<double>(out[i].vertices) / static_cast<double>(all) : 0;
    }
    std::erase_if(out, [](const DensityClass& c) { return c.length == 0 && c.vertices == 0; });
    return out;
}

}  // namespace

EdgeFlowReport edge_flow(const PolygonMesh& mesh, const HalfEdges& edges, const Skeleton& skeleton,
                         const CapsuleTree& capsules, const VertexPlaces& places, const Context& ctx) {
    constexpr double kForkReach = 2;  // [radii]
    const std::vector<char> on_ring = vertices_on_rings(mesh, EdgeLoops(edges), capsules, places);
    ctx.throw_if_cancelled();
    const measure_internal::Forks forks(skeleton, mesh.origin, kForkReach, ctx);
    using Count = std::array<std::uint64_t, 2>;
    const auto count = [&](IndexRange range) {
        Count n{};
        for (std::size_t v = range.begin; v < range.end; ++v) {
            if (places.is_regular[v] == 0 || forks.contain(Vec3d(mesh.positions[v]))) continue;
            ++n[0];
            n[1] += on_ring[v] != 0 ? 1 : 0;
        }
        return n;
    };
    const Count n =
        parallel_reduce(ctx, on_ring.size(), kEdgeFlowGrain, Count{}, count, [](Count a, Count b) {
            return Count{a[0] + b[0], a[1] + b[1]};
        });
    return {n[0], n[1], density(mesh, capsules, places)};
}

}  // namespace coppice
