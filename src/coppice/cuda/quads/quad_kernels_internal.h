#pragma once

#include <cstdint>
#include <span>

#include "coppice/base/id.h"
#include "coppice/cuda/exec/atomics_internal.h"
#include "coppice/subdivision/kernel/face_kernel.h"
#include "coppice/subdivision/kernel/flat_ends.h"
#include "coppice/subdivision/kernel/gradient_kernel.h"
#include "coppice/subdivision/kernel/refine_kernel.h"

namespace coppice::cuda {

/// Points that are subdivided in the same way.
struct PointPair {
    std::span<Vec3> positions;  ///< [m] one per vertex
    std::span<Vec3> anchors;    ///< [m] one per vertex
};

/// One Catmull-Clark step from patches of N x N quads: one thread for every vertex inside a cage quad, for
/// every cage edge, and for every cage vertex.
template <int N>
struct RefineLevel {
    CageView cage;
    PointPair in, out;

    COPPICE_HOST_DEVICE std::size_t size() const {
        return std::size_t{cage.face_count()} * kInside + cage.edge_count() + cage.vertex_count();
    }
    COPPICE_HOST_DEVICE void operator()(std::uint32_t i) const {
        refine(i, in.positions, out.positions);
        refine(i, in.anchors, out.anchors);
    }

  private:
    static constexpr std::uint32_t kWidth = 2 * N - 1, kInside = kWidth * kWidth;

    COPPICE_HOST_DEVICE void refine(std::uint32_t i, std::span<const Vec3> from, std::span<Vec3> to) const {
        const PatchIndex<N> index(cage);
        const PatchIndex<2 * N> finer(cage);
        const std::uint32_t inside = cage.face_count() * kInside;
        if (i < inside) {
            const std::uint32_t f = i / kInside, k = i % kInside;
            to[finer.face_begin(0) + i] =
                refine_face_point<N>(index, f, k % kWidth + 1, k / kWidth + 1, from);
        } else if (i - inside < cage.edge_count()) {
            refine_edge<N>(cage, index, i - inside, from, &to[finer.edge_begin(i - inside)]);
        } else {
            const std::uint32_t v = i - inside - cage.edge_count();
            to[v] = refine_vertex<N>(cage, index, v, from);
        }
    }
};

/// Writes the refined quads.
struct WriteQuads {
    PatchStars stars;
    std::span<Quad> out;
    COPPICE_HOST_DEVICE void operator()(std::uint32_t q) const { out[q] = stars.quad(q); }
};

/// Outcome of the projection of a vertex: see ProjectReport.
struct ProjectionStatus {
    std::uint8_t evaluations = 0;  ///< of the field
    std::uint8_t most = 0;         ///< maximum along the ray or along the gradient
    bool not_converged = false;    ///< left at its best point so far
    bool anchor_outside = false;   ///< no surface between anchor and start
};

/// Parameters of the projection of vertices.
struct ProjectionRule {
    kernel::RayLimits<float> ray;  ///< along rays
    WalkRule walk;                 ///< along the gradient
    int max_evaluations;           ///< for each of the two methods
    bool along_rays;               ///< along rays first
};

/// Moves individual vertices onto a field.
template <class Field>
class Projector {
  public:
    COPPICE_HOST_DEVICE Projector(const Field& field, const ProjectionRule& rule)
        : field_(field), rule_(rule) {}

    /// Moves along the ray of project(), and along the gradient if the ray meets no surface.
    COPPICE_HOST_DEVICE Vec3 project(std::uint32_t region, Vec3 anchor, Vec3 start,
                                     ProjectionStatus& status) const {
        if (!rule_.along_rays) return along_gradient(region, anchor, start, status);
        bool found = true;
        const Vec3 end = along_ray(region, anchor, start, status, found);
        if (found) return end;
        status.not_converged = false;
        ProjectionStatus again;
        const Vec3 last = along_gradient(region, anchor, end, again);
        status.evaluations = static_cast<std::uint8_t>(status.evaluations + again.evaluations);
        status.most = kernel::larger(status.most, again.most);
        status.not_converged = again.not_converged;
        return last;
    }

    /// Moves only along the ray; `found` is false if it meets no surface.
    COPPICE_HOST_DEVICE Vec3 along_ray(std::uint32_t region, Vec3 anchor, Vec3 start,
                                       ProjectionStatus& status, bool& found) const {
        const AnchorRay way(anchor, start);
        if (!way.is_usable) return start;
        constexpr float kInfinity = std::numeric_limits<float>::infinity();
        kernel::RayState<float> ray{1, 0, kInfinity, 1, kInfinity};
        kernel::RayLimits<float> limits = rule_.ray;
        const Vec3 d = way.direction;
        for (int evaluation = 1; evaluation <= rule_.max_evaluations; ++evaluation) {
            const FieldSample s = field_.sample(region, way.anchor + d * ray.t);
            const auto here =
                kernel::read_on_ray(s.value, s.gradient.x, s.gradient.y, s.gradient.z, d.x, d.y, d.z, 1.0f);
            limits.slow = evaluation > 4 && evaluation % 2 == 0;
            const auto verdict = kernel::advance_ray(here, limits, ray);
            status.most = status.evaluations = static_cast<std::uint8_t>(evaluation);
            const Vec3 point = way.anchor + d * ray.t;
            if (verdict.endless || verdict.empty) {
                found = false;
                status.not_converged = true;
                status.anchor_outside = verdict.empty && !verdict.endless;
                return point;
            }
            if (verdict.converged) return point;
        }
        // The maximum number of evaluations is reached.
        status.not_converged = true;
        found = ray.inside > 0;
        status.anchor_outside = !found;
        return way.anchor + d * (found ? ray.best_t : 1.0f);
    }

  private:
    COPPICE_HOST_DEVICE Vec3 along_gradient(std::uint32_t region, Vec3 anchor, Vec3 start,
                                            ProjectionStatus& status) const {
        const AnchorRay way(anchor, start);
        if (!way.is_usable) return start;
        GradientWalk walk(way.anchor, way.direction);
        WalkOutcome outcome = WalkOutcome::running;
        for (int evaluation = 1; outcome == WalkOutcome::running && evaluation <= rule_.max_evaluations;
             ++evaluation) {
            outcome = walk.advance(read_sample(field_.sample(region, walk.point()), 1.0f), rule_.walk);
            status.most = status.evaluations = static_cast<std::uint8_t>(evaluation);
        }
        const Vec3 end = walk.result(outcome);
        status.not_converged = outcome == WalkOutcome::failed || outcome == WalkOutcome::no_surface;
        status.anchor_outside = outcome == WalkOutcome::no_surface;
        return end;
    }

    Field field_;
    ProjectionRule rule_;
};

/// Refined vertices and the data on which their projection depends.
struct SurfaceView {
    PatchStars stars;                       ///< connectivity
    int levels;                             ///< number of subdivisions
    std::span<const std::uint32_t> region;  ///< of the field, per cage quad
    std::span<const ClipPlane> clips;       ///< of flat ends, by first quad
    PointPair points;                       ///< refined points
    std::span<ProjectionStatus> status;     ///< per refined vertex
};

/// Moves every vertex that has a quad and is not on a flat end.
template <class Field>
struct ProjectVertices {
    SurfaceView surface;
    Projector<Field> projector;

    COPPICE_HOST_DEVICE void operator()(std::uint32_t v) const {
        ProjectionStatus status;
        const std::uint32_t owner = surface.stars.owner(v);
        const FlatEnds ends(surface.clips);
        const bool moves =
            owner != kNoIndex && ends.of_vertex(surface.stars, surface.levels, v).end == kNoIndex;
        if (moves) {
            Vec3& p = surface.points.positions[v];
            p = projector.project(surface.region[owner], surface.points.anchors[v], p, status);
        }
        surface.status[v] = status;
    }
};

/// The vertices of flat ends: see FlatVertices.
struct FlatView {
    std::span<const std::uint32_t> first, vertex;
    std::span<const std::uint32_t> end;  ///< per vertex: index of its end
    std::span<const std::uint8_t> on_rim;
    std::span<float>
        change;  ///< ratio of the distances from the anchor, on the rim; infinite for a distance of 0
};

/// Projects the vertices of flat ends onto their planes, and moves the rim along rays within them.
template <class Field>
struct ProjectFlat {
    SurfaceView surface;
    FlatView flat;
    Projector<Field> projector;

    COPPICE_HOST_DEVICE void operator()(std::uint32_t k) const {
        const std::uint32_t v = flat.vertex[k];
        const ClipPlane& plane = surface.clips[flat.end[k]];
        Vec3& p = surface.points.positions[v];
        p = dropped(p, plane);
        if (flat.on_rim[k] == 0) return;
        const Vec3 anchor = dropped(surface.points.anchors[v], plane);
        const float radius = distance(p, anchor);
        ProjectionStatus status;
        bool found = true;
        p = dropped(projector.along_ray(surface.region[plane.first_quad], anchor, p, status, found), plane);
        surface.status[v] = status;
        flat.change[k] = radius > 0 ? distance(p, anchor) / radius : std::numeric_limits<float>::infinity();
    }
};

/// Center of the rim of an end, and its minimum scale.
struct RimChange {
    Vec3 center;
    float scale;
    bool has_rim;
};

/// Computes the change of each rim.
struct MeasureRim {
    SurfaceView surface;
    FlatView flat;
    std::span<RimChange> out;

    COPPICE_HOST_DEVICE void operator()(std::uint32_t end) const {
        std::uint32_t count = 0;
        for (std::uint32_t k = flat.first[end]; k < flat.first[end + 1]; ++k) count += flat.on_rim[k];
        RimChange change{{}, std::numeric_limits<float>::infinity(), count > 0};
        for (std::uint32_t k = flat.first[end]; k < flat.first[end + 1]; ++k) {
            if (flat.on_rim[k] == 0) continue;
            const Vec3 anchor = dropped(surface.points.anchors[flat.vertex[k]], surface.clips[end]);
            change.center += anchor / static_cast<float>(count);
            change.scale = kernel::smaller(change.scale, flat.change[k]);
        }
        if (!std::isfinite(change.scale)) change.scale = 1;
        out[end] = change;
    }
};

/// Scales the interior of a flat end with its rim.
struct FollowRim {
    SurfaceView surface;
    FlatView flat;
    std::span<const RimChange> change;

    COPPICE_HOST_DEVICE void operator()(std::uint32_t k) const {
        const RimChange& rim = change[flat.end[k]];
        if (flat.on_rim[k] != 0 || !rim.has_rim) return;
        Vec3& p = surface.points.positions[flat.vertex[k]];
        p = dropped(lerp(rim.center, p, rim.scale), surface.clips[flat.end[k]]);
    }
};

/// Sums over the vertices of one report: see ProjectReport.
struct ProjectionSums {
    unsigned long long vertices, evaluations, not_converged, anchors_outside;
    unsigned int most;
};

/// Sums up kPerThread vertices, by report.
struct SumStatus {
    static constexpr std::uint32_t kPerThread = 64;

    PatchStars stars;
    std::span<const std::uint32_t> part;  ///< see QuadJob
    std::span<const ProjectionStatus> status;
    std::span<ProjectionSums> sums;  ///< per report, initially 0

    static std::size_t thread_count(std::size_t vertices) { return (vertices + kRun - 1) / kRun * kLanes; }

    COPPICE_HOST_DEVICE void operator()(std::uint32_t i) const {
        ProjectionSums sum{};
        auto current = static_cast<std::uint32_t>(sums.size());
        // Adjacent threads read adjacent elements, and each thread reads nearby ones, which usually belong to
        // one report.
        std::uint32_t v = i / kLanes * kRun + i % kLanes;
        for (std::uint32_t k = 0; k < kPerThread && v < status.size(); ++k, v += kLanes) {
            const std::uint32_t owner = stars.owner(v);
            if (owner == kNoIndex) continue;
            const std::uint32_t here = part.empty() ? 0 : part[owner];
            if (here != current) {
                add(current, sum);
                sum = {};
                current = here;
            }
            const ProjectionStatus s = status[v];
            ++sum.vertices;
            sum.evaluations += s.evaluations;
            sum.not_converged += s.not_converged;
            sum.anchors_outside += s.anchor_outside;
            sum.most = kernel::larger(sum.most, static_cast<unsigned int>(s.most));
        }
        add(current, sum);
    }

  private:
    static constexpr std::uint32_t kLanes = 32, kRun = kLanes * kPerThread;

    COPPICE_HOST_DEVICE void add(std::uint32_t to, const ProjectionSums& sum) const {
        if (to >= sums.size() || sum.vertices == 0) return;
        add_to(sums[to].vertices, sum.vertices);
        add_to(sums[to].evaluations, sum.evaluations);
        if (sum.not_converged != 0) add_to(sums[to].not_converged, sum.not_converged);
        if (sum.anchors_outside != 0) add_to(sums[to].anchors_outside, sum.anchors_outside);
        raise_to(sums[to].most, sum.most);
    }
};

/// Executes a tangential step: see TangentialRelaxation.
struct RelaxVertices {
    PatchStars stars;
    float weight;
    std::span<const Vec3> in;
    std::span<Vec3> out;

    COPPICE_HOST_DEVICE void operator()(std::uint32_t v) const {
        const Vec3 p = in[v];
        Vec3 neighbours, normal;
        float count = 0;
        stars.for_each_corner(v, [&](QuadCorner c) {
            const Quad quad = stars.quad(c.quad);
            const Vec3 after = in[quad[(c.corner + 1) & 3]] - p;
            neighbours += after;
            normal += cross(after, in[quad[(c.corner + 3) & 3]] - p);
            count += 1;
        });
        const float squared = length_squared(normal);
        const bool stays = count == 0 || stars.on_boundary(v) || !(squared > 0);
        const Vec3 move = stays ? Vec3{} : neighbours / count;
        out[v] = stays ? p : p + weight * (move - normal * (dot(move, normal) / squared));
    }
};

/// Computes the normals of vertices: the directions of the sums of their corners' areas.
struct VertexNormals {
    PatchStars stars;
    std::span<const Vec3> positions;
    std::span<Vec3> out;

    COPPICE_HOST_DEVICE void operator()(std::uint32_t v) const {
        const Vec3 p = positions[v];
        Vec3 normal;
        stars.for_each_corner(v, [&](QuadCorner c) {
            const Quad quad = stars.quad(c.quad);
            normal += cross(positions[quad[(c.corner + 1) & 3]] - p, positions[quad[(c.corner + 3) & 3]] - p);
        });
        out[v] = normalized(normal);
    }
};

}  // namespace coppice::cuda
