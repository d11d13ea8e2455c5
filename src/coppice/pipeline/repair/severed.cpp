#include "coppice/pipeline/repair/severed_internal.h"

#include <algorithm>
#include <cmath>
#include <cstdint>

#include "coppice/base/parallel.h"
#include "coppice/base/sort.h"
#include "coppice/measure/axes.h"
#include "coppice/measure/capsule_tree.h"
#include "coppice/pipeline/end_shapes_internal.h"
#include "coppice/skeleton/segment_cone.h"

namespace coppice::pipeline_internal {
namespace {

constexpr std::size_t kGrain = 256;
constexpr float kNear = 0.75f;  // [radii] distance from an axis to its quads below which it may be severed
constexpr float kReach = 2;     // [radii] distance from such a segment within which faces are checked
constexpr float kStep = 0.5f;   // [radii] spacing of the positions of an axis at which rows are selected

using Flags = std::vector<std::uint8_t>;

BasicRoundCone<float> compute_cone(const Skeleton& s, NodeId n) {
    if (s.is_root(n)) return round_cone(s.position(n), s.position(n), s.radius(n), s.radius(n));
    return round_cone<float>(s.segment(n));
}

// Of the tubes around a segment the one closest to a point of it.
NodeId nearest_tube(const QuadBuild& build, NodeId segment, Vec3 p) {
    NodeId best;
    float least = 0;
    for (const NodeId tube : build.wrapping[segment.index()]) {
        const float d = length(compute_cone(build.tubes, tube).closest_point(p).offset);
        if (best && d >= least) continue;
        best = tube;
        least = d;
    }
    return best;
}

// Returns whether refined quads are close to an axis: tests one corner and the centre of each, since corners
// are shared.
bool comes_near(const BasicRoundCone<float>& axis, const CageRun& run, const TubeQuads& quads) {
    std::span<const Vec3> x = quads.mesh.positions;
    const auto is_near = [&](Vec3 p) { return axis.closest_point(p).relative_squared() < kNear * kNear; };
    const int shift = 2 * quads.tube_rows.levels();
    const std::uint32_t end = (run.first + run.count) << shift;
    for (std::uint32_t q = run.first << shift; q < end; ++q) {
        const Quad& f = quads.mesh.quads[q];
        if (is_near(x[f[0]]) || is_near(0.5f * (x[f[0]] + x[f[2]]))) return true;
    }
    return false;
}

// Returns whether the quads of a tube, or of those that it meets at branch nodes, are close to an axis that
// it wraps.
bool is_pressed(NodeId tube, const BasicRoundCone<float>& axis, const TubeQuads& quads) {
    const auto come_near = [&](NodeId t) {
        const TubeFaces& faces = quads.faces[t.index()];
        return comes_near(axis, faces.side, quads) || comes_near(axis, faces.beyond(0), quads) ||
               comes_near(axis, faces.beyond(1), quads);
    };
    const TubeRows& tube_rows = quads.tube_rows;
    bool is_near = come_near(tube);
    if (tube_rows.tubes().is_root(tube)) return is_near;
    for (const int end : {0, 1}) {
        if (!tube_rows.is_fork(tube_rows.node(tube, end))) continue;
        tube_rows.for_each_tube_at(tube_rows.node(tube, end),
                                   [&](NodeId t) { is_near = is_near || (t != tube && come_near(t)); });
    }
    return is_near;
}

// Per node of the field's skeleton: whether its axis may be severed, or its tip short.
Flags doubtful_segments(const QuadBuild& build, const TubeQuads& quads, const Context& ctx) {
    Flags out(build.skeleton.size(), 0);
    parallel_for(ctx, out.size(), kGrain, [&](std::size_t i) {
        const NodeId n(static_cast<std::uint32_t>(i));
        if (build.skeleton.is_root(n)) return;
        const auto axis = round_cone<float>(build.skeleton.segment(n));
        const bool is_near = std::ranges::any_of(build.wrapping[i],
                                                 [&](NodeId tube) { return is_pressed(tube, axis, quads); });
        out[i] = is_near || is_hidden_tip(n, build) ? 1 : 0;
    });
    return out;
}

// The faces near some segments.
PolygonMesh faces_about(const Flags& segments, const Skeleton& s, const TubeQuads& quads,
                        const Context& ctx) {
    std::vector<Box3> boxes;
    for (const NodeId n : nodes(s)) {
        if (segments[n.index()] == 0) continue;
        const Segment g = s.segment(n);
        boxes.push_back(capsule_box(g.a, g.b, kReach * std::max(g.radius_a, g.radius_b)));
    }
    if (boxes.empty()) return {};
    return some_faces(quads.mesh, quads_near(quads, BoxTree(boxes, ctx), ctx));
}

// Adds the rows along a section of an axis.
void add_slices(const SeveredRange& part, const QuadBuild& build, const TubeRows& tube_rows,
                std::vector<TubeRow>& out) {
    const auto axis = round_cone<float>(build.skeleton.segment(part.node));
    const auto from = static_cast<float>(part.from), share = static_cast<float>(part.to - part.from);
    const float way = length(axis.axis) * share;
    const auto steps = static_cast<int>(std::max(1.0f, std::ceil(way / (kStep * axis.radius(from)))));
    for (int k = 0; k < steps; ++k) {
        const Vec3 p = axis.point(from + share * (static_cast<float>(k) + 0.5f) / static_cast<float>(steps));
        out.push_back(tube_rows.near(nearest_tube(build, part.node, p), p));
    }
}

}  // namespace

bool is_hidden_tip(NodeId n, const QuadBuild& build) {
    const std::span<const NodeId> wrapping = build.wrapping[n.index()];
    const auto is_tip = [&](NodeId tube) { return build.tubes.is_tip(tube); };
    return build.skeleton.is_tip(n) && !wrapping.empty() && std::ranges::none_of(wrapping, is_tip);
}

std::vector<TubeRow> find_severed_rows(const QuadBuild& build, const TubeQuads& quads, const Context& ctx) {
    const Flags doubtful = doubtful_segments(build, quads, ctx);
    const Skeleton& s = build.skeleton;
    const PolygonMesh faces = faces_about(doubtful, s, quads, ctx);
    if (faces.face_count() == 0) return {};
    const CapsuleTree segments(s, s.origin(), ctx);
    const std::vector<SeveredRange> parts =
        find_severed_ranges(faces, s, segments, tip_end(build.options.control), doubtful, ctx);
    std::vector<TubeRow> out;
    for (SeveredRange part : parts) {
        if (is_hidden_tip(part.node, build)) part.from = 0;  // the whole branch is in the tube of another one
        add_slices(part, build, quads.tube_rows, out);
    }
    sort_unique(out);
    return out;
}

}  // namespace coppice::pipeline_internal
