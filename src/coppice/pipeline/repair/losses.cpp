#include "coppice/pipeline/repair/losses_internal.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <optional>

#include "coppice/base/id.h"
#include "coppice/base/parallel.h"
#include "coppice/base/sort.h"
#include "coppice/measure/capsule_tree.h"
#include "coppice/measure/intersections.h"
#include "coppice/measure/surface_tree.h"
#include "coppice/skeleton/segment_cone.h"

namespace coppice::pipeline_internal {
namespace {

constexpr float kSteep = 0.7f;    // change of the radius per length of a segment
constexpr float kThick = 1.5f;    // [radii of the tube] minimum radius of a node that is thicker than a tube
constexpr float kReach = 2;       // [radii] distance from a node within which faces are checked
constexpr double kMissing = 0.4;  // [radii] minimum distance of a missing point from the surface
constexpr float kDepth = 0.8f;    // [radii] distance of the tested points from a node
constexpr double kInside = 0.85;  // rho below which a point is certainly inside

// The corners and the midpoints of the faces of a cube, as directions.
std::array<Vec3, 14> directions() {
    std::array<Vec3, 14> out;
    std::size_t k = 0;
    for (const float x : {-1.0f, 1.0f}) {
        for (int axis = 0; axis < 3; ++axis) {
            out[k] = {};
            out[k++][axis] = x;
        }
        for (const float y : {-1.0f, 1.0f}) {
            for (const float z : {-1.0f, 1.0f}) out[k++] = normalized(Vec3(x, y, z));
        }
    }
    return out;
}

bool is_steep(const Segment& s) { return std::abs(s.radius_a - s.radius_b) > kSteep * distance(s.a, s.b); }

// Returns whether the end of a segment is much thicker than the tube that wraps it, or than adjacent tubes if
// there is none.
bool is_too_thick(const QuadBuild& build, NodeId n) {
    const Skeleton& s = build.skeleton;
    float widest = 0;
    if (const auto wrapping = build.wrapping[n.index()]; !wrapping.empty()) {
        const NodeId tube = wrapping.back();
        // A tree within one node has the ball of that node as its tube.
        widest = build.tubes.is_root(tube)
                     ? build.tubes.radius(tube)
                     : round_cone<float>(build.tubes.segment(tube)).closest_point(s.position(n)).radius;
    } else {
        for_each_segment_at(s, s.parent(n), [&](NodeId neighbour) {
            if (!build.wrapping[neighbour.index()].empty()) widest = std::max(widest, s.radius(neighbour));
        });
    }
    return s.radius(n) > kThick * widest;
}

// Returns the nodes at which a part may be missing.
std::vector<NodeId> doubtful_nodes(const QuadBuild& build) {
    const Skeleton& s = build.skeleton;
    std::vector<std::uint8_t> is_doubtful(s.size(), 0);
    for (const NodeId n : nodes(s)) {
        if (s.is_root(n)) continue;
        if (is_too_thick(build, n) || is_steep(s.segment(n))) {
            is_doubtful[n.index()] = is_doubtful[s.parent(n).index()] = 1;
        }
    }
    std::vector<NodeId> out;
    for (const NodeId n : nodes(s)) {
        if (is_doubtful[n.index()] != 0) out.push_back(n);
    }
    return out;
}

// The balls around the nodes, in which faces are checked.
BoxTree balls_about(std::span<const NodeId> around, const Skeleton& s, const Context& ctx) {
    std::vector<Box3> balls;
    for (const NodeId n : around)
        balls.push_back(Box3{s.position(n), s.position(n)}.inflated(kReach * s.radius(n)));
    return BoxTree(balls, ctx);
}

// The segments that overlap the balls: no other contains a point there.
CapsuleTree cones_within(const BoxTree& balls, const Skeleton& s, const Context& ctx) {
    std::vector<NodeId> segments;
    std::vector<RoundCone> cones;
    for (const NodeId n : nodes(s)) {
        if (s.is_root(n)) continue;
        const auto cone = round_cone<double>(s.segment(n));
        Box3 box = Box3{Vec3(cone.a), Vec3(cone.a)}.inflated(static_cast<float>(cone.radius_a));
        box.extend(Box3{Vec3(cone.b()), Vec3(cone.b())}.inflated(static_cast<float>(cone.radius_b())));
        if (!balls.meets(box)) continue;
        segments.push_back(n);
        cones.push_back(cone);
    }
    return CapsuleTree(std::move(segments), std::move(cones), ctx);
}

// Returns the row closest to a point.
TubeRow nearest_slice(const CapsuleTree& tubes, const TubeRows& tube_rows, Vec3 p) {
    const auto near = tubes.nearest(Vec3d(p)).capsule;
    return near == kNoIndex ? kNoIndex : tube_rows.near(tubes.node(near), p);
}

}  // namespace

std::vector<TubeRow> find_lossy_rows(const QuadBuild& build, const TubeQuads& quads, const Context& ctx) {
    const std::vector<NodeId> doubtful = doubtful_nodes(build);
    if (doubtful.empty()) return {};
    const Skeleton& s = build.skeleton;
    const BoxTree balls = balls_about(doubtful, s, ctx);
    const CapsuleTree cones = cones_within(balls, s, ctx);
    const PolygonMesh polygons = some_faces(quads.mesh, quads_near(quads, balls, ctx));
    if (polygons.face_count() == 0) return {};
    const SurfaceTree surface(polygons, ctx);
    const auto around = directions();
    std::vector<std::optional<Vec3>> lost(doubtful.size());  // a missing point of each node
    parallel_for(ctx, lost.size(), 16, [&](std::size_t i) {
        const Vec3 c = s.position(doubtful[i]);
        const float r = s.radius(doubtful[i]);
        for (const Vec3 d : around) {
            const Vec3 p = c + d * (kDepth * r);
            if (cones.nearest(Vec3d(p)).rho > kInside ||
                surface.signed_distance(Vec3d(p)) <= kMissing * static_cast<double>(r))
                continue;
            lost[i] = p;
            break;
        }
    });
    std::erase(lost, std::nullopt);
    if (lost.empty()) return {};
    const CapsuleTree tubes(build.tubes, s.origin(), ctx);
    std::vector<TubeRow> found;
    for (const auto& p : lost) found.push_back(nearest_slice(tubes, quads.tube_rows, *p));
    std::erase(found, kNoIndex);
    sort_unique(found);
    return found;
}

}  // namespace coppice::pipeline_internal
