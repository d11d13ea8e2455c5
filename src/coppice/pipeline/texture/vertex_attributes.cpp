#include "coppice/pipeline/texture/vertex_attributes_internal.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <initializer_list>
#include <optional>

#include "coppice/base/parallel.h"
#include "coppice/measure/capsule_tree.h"
#include "coppice/pipeline/texture/tube_texture_internal.h"
#include "coppice/skeleton/branches.h"

namespace coppice::pipeline_internal {
namespace {

constexpr std::size_t kVertexGrain = 1024;

// The axes of a skeleton, with lengths.
class SkeletonAxes {
  public:
    explicit SkeletonAxes(const Skeleton& s) : s_(s), table_(list_branches(s)), end_(s.size(), 0) {
        for (const NodeId n : nodes(s)) {
            if (s.is_root(n)) continue;
            const double before = table_.position_of[n.index()] == 1 ? 0 : end_[s.parent(n).index()];
            end_[n.index()] = before + double{distance(s.position(s.parent(n)), s.position(n))};
        }
    }

    std::uint32_t order(NodeId segment) const { return branch(segment).order; }

    // Returns the closest to a point of a segment and the adjacent ones of its branch.
    NodeId closest(NodeId segment, Vec3 p) const {
        NodeId best = s_.is_root(segment) ? table_.next_of[segment.index()] : segment;
        if (!best) return segment;
        for (const NodeId n : {s_.parent(best), table_.next_of[best.index()]}) {
            if (!n || s_.is_root(n) || number(n) != number(best)) continue;
            if (squared_distance(n, p) < squared_distance(best, p)) best = n;
        }
        return best;
    }

    // Returns the order, the number of the branch, the distance and the radius.
    std::array<float, 4> at(NodeId segment, Vec3 p) const {
        const auto of = static_cast<float>(number(segment));
        if (s_.is_root(segment)) return {0, of, 0, s_.radius(segment)};
        const Segment cone = s_.segment(segment);
        const float t = parameter(cone, p);
        const double way = end_[segment.index()] - (1 - double{t}) * double{distance(cone.a, cone.b)};
        return {static_cast<float>(order(segment)), of, static_cast<float>(std::max(way, 0.0)),
                std::lerp(cone.radius_a, cone.radius_b, t)};
    }

  private:
    const Branch& branch(NodeId segment) const { return table_.branches[number(segment)]; }
    std::uint32_t number(NodeId segment) const { return table_.branch_of[segment.index()]; }
    static float parameter(const Segment& s, Vec3 p) {
        const Vec3 axis = s.b - s.a;
        return std::clamp(dot(p - s.a, axis) / std::max(length_squared(axis), 1e-30f), 0.0f, 1.0f);
    }
    float squared_distance(NodeId segment, Vec3 p) const {
        const Segment s = s_.segment(segment);
        return length_squared(p - lerp(s.a, s.b, parameter(s, p)));
    }

    const Skeleton& s_;
    BranchTable table_;
    std::vector<double> end_;  // [m] along the branch, by segment
};

// Returns the segments that the tubes of the vertices wrap; none for other vertices.
std::vector<NodeId> find_wrapped(const QuadMesh& mesh, const QuadBuild& build, const SkeletonAxes& axes) {
    std::vector<NodeId> out(mesh.positions.size());
    const auto add = [&](std::size_t face, std::uint32_t cage_quad) {
        const NodeId wrapped = build.cage.region_node[build.cage.region[cage_quad]];
        const NodeId segment = build.prepared_node[wrapped.index()];
        for (const std::uint32_t v : mesh.quads[face]) {
            if (!out[v] || axes.order(segment) < axes.order(out[v])) out[v] = segment;
        }
    };
    if (!build.coarse.quads.empty()) {
        for (std::size_t i = 0; i < build.coarse.quads.size(); ++i) add(i, build.coarse.cage_quad[i]);
        return out;
    }
    const int levels = build.refinement.levels();
    const std::vector<std::uint32_t> kept =
        find_kept_quads(build, TubeRows(build.cage, build.tubes, levels, build.sides));
    for (std::size_t i = 0; i < kept.size(); ++i) add(i, kept[i] >> (2 * levels));
    return out;
}

// Returns the attributes; vertices without a segment belong to the closest.
std::vector<VertexAttribute> evaluate(std::span<const Vec3> positions, Vec3d origin, const Skeleton& prepared,
                                      const SkeletonAxes& axes, std::span<const NodeId> wrapped,
                                      const Context& ctx) {
    std::vector<VertexAttribute> out;
    for (const char* name : {"order", "branch", "distance", "radius"})
        out.push_back({name, Buffer<float>(positions.size())});
    std::optional<CapsuleTree> capsules;
    if (std::ranges::any_of(wrapped, [](NodeId segment) { return !segment; }))
        capsules.emplace(prepared, origin, ctx);
    const Vec3 shift(origin - prepared.origin());
    const auto find_segment = [&](std::size_t v) {
        if (wrapped[v]) return axes.closest(wrapped[v], positions[v] + shift);
        const std::uint32_t nearest = capsules->nearest(Vec3d(positions[v])).capsule;
        return nearest != kNoIndex ? capsules->node(nearest) : NodeId(0);
    };
    parallel_for(ctx, positions.size(), kVertexGrain, [&](std::size_t v) {
        const std::array<float, 4> values = axes.at(find_segment(v), positions[v] + shift);
        for (std::size_t i = 0; i < values.size(); ++i) out[i].values[v] = values[i];
    });
    return out;
}

}  // namespace

std::vector<VertexAttribute> vertex_attributes(const QuadMesh& mesh, const QuadBuild& build,
                                               const Skeleton& prepared, const Context& ctx) {
    const SkeletonAxes axes(prepared);
    return evaluate(mesh.positions, mesh.origin, prepared, axes, find_wrapped(mesh, build, axes), ctx);
}

std::vector<VertexAttribute> vertex_attributes(std::span<const Vec3> positions, Vec3d origin,
                                               const Skeleton& prepared, const Context& ctx) {
    return evaluate(positions, origin, prepared, SkeletonAxes(prepared),
                    std::vector<NodeId>(positions.size()), ctx);
}

}  // namespace coppice::pipeline_internal
