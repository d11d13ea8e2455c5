#include "coppice/pipeline/surface_verdict.h"

#include "coppice/measure/cone_union.h"
#include "coppice/measure/intersections.h"
#include "coppice/measure/surface_tree.h"
#include "coppice/pipeline/end_shapes_internal.h"
#include "coppice/pipeline/fit/measured_volume_internal.h"
#include "coppice/pipeline/mesh_skeleton.h"

namespace coppice {
namespace {

SurfaceVerdict judge(const FaceView& mesh, Vec3d origin, const MeshResult& result, const Skeleton& skeleton,
                     const ControlOptions& ends, const Context& ctx) {
    const ConeUnion solid(skeleton, origin, base_end(ends), tip_end(ends), ctx);
    SurfaceVerdict out;
    if (result.fitted) {
        out.volume = {
            .mesh = result.fitted->after, .cones = result.fitted->cones, .error = result.fitted->error};
    } else if (result.measured) {
        out.volume = result.measured;
    } else if (ends.base != BaseShape::open) {
        out.volume = pipeline_internal::measured_volume(mesh, solid, ctx);
    }
    out.axes = judge_axes(mesh, skeleton, solid, tip_end(ends), ctx).report;
    return out;
}

// Returns the number of pairs of quads that cross. Surfaces that are not remeshed are searched here.
std::uint64_t count_crossings(const QuadSurface& surface, const Context& ctx) {
    constexpr std::uint32_t kMaxPairs = 1'000'000;
    if (surface.repair.is_searched) return surface.repair.pairs_after;
    const PolygonMesh mesh = to_polygons(surface.mesh);
    return crossing_faces(SurfaceTree(mesh, ctx), kMaxPairs, ctx).pairs.size();
}

}  // namespace

std::optional<SurfaceVerdict> judge_surface(const MeshResult& result, const Skeleton& skeleton,
                                            const ControlOptions& ends, const Context& ctx) {
    if (result.bent_apart) return {};
    if (const auto* quads = std::get_if<QuadSurface>(&result.surface)) {
        SurfaceVerdict out = judge(quads->mesh, quads->mesh.origin, result, skeleton, ends, ctx);
        out.crossings = count_crossings(*quads, ctx);
        return out;
    }
    if (std::holds_alternative<TetraSurface>(result.surface)) {
        const PolygonMesh mesh = to_polygons(result);
        return judge(mesh, mesh.origin, result, skeleton, ends, ctx);
    }
    return {};
}

}  // namespace coppice
