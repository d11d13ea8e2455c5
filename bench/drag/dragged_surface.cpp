#include "drag/dragged_surface.h"

#include <cstdint>
#include <vector>

#include "coppice/base/parallel.h"
#include "coppice/field/convolution_field.h"
#include "coppice/implicit/field_ref.h"
#include "coppice/mesh/normals.h"
#include "coppice/pipeline/field_regions_internal.h"

namespace coppice::bench {
namespace {

constexpr std::size_t kDragGrain = 4096;

Skeleton moved(const Skeleton& s, const std::vector<Vec3>& positions) {
    return {{s.parents().begin(), s.parents().end()},
            positions,
            {s.radii().begin(), s.radii().end()},
            s.origin(),
            {s.stable_ids().begin(), s.stable_ids().end()}};
}

Buffer<Vec3> picked(std::span<const Vec3> values, std::span<const std::uint32_t> which) {
    Buffer<Vec3> out(which.size());
    for (std::size_t i = 0; i < which.size(); ++i) out[i] = values[which[i]];
    return out;
}

}  // namespace

DraggedSurface::DraggedSurface(const QuadBuild& build, const DragPart& part, const Context&)
    : build_(&build),
      part_(&part),
      positions_(picked(build.refined, part.vertex)),
      normals_(smooth_normals(positions_, part.quads)) {}

ProjectReport DraggedSurface::project_part(const DragPose& pose, Buffer<Vec3>& positions,
                                           const Context& ctx) const {
    const Skeleton skeleton = moved(build_->skeleton, pose.nodes);
    const Skeleton tubes = moved(build_->tubes, pose.tube_nodes);
    ConvolutionField field(skeleton, build_->field, ctx);
    field.set_regions(
        pipeline_internal::field_regions(build_->cage, part_->cage_quad, {pose.cage, pose.anchors}, skeleton),
        {tubes, build_->tube}, ctx);
    const std::vector<ClipPlane> clips = select_clip_planes(*part_, pose.clips);
    positions = part_->patches.refine(picked(pose.cage, part_->cage_vertex), ctx);
    const Buffer<Vec3> anchors = part_->patches.refine(picked(pose.anchors, part_->cage_vertex), ctx);
    const ProjectionTarget target{FieldRef(field), part_->region, clips};
    return project(positions, anchors, part_->patches, target, build_->options.project, ctx);
}

ProjectReport DraggedSurface::make(const DragPose& pose, const Context& ctx) {
    Buffer<Vec3> refined;
    const ProjectReport report = project_part(pose, refined, ctx);
    parallel_for(ctx, part_->written, kDragGrain,
                 [&](std::size_t i) { positions_[i] = refined[part_->from[i]]; });
    parallel_for(ctx, part_->shaded, kDragGrain,
                 [&](std::size_t i) { normals_[i] = fan_normal(positions_, part_->quads, part_->fans[i]); });
    return report;
}

}  // namespace coppice::bench
