#include "coppice/tetra/march/march.h"

#include <algorithm>
#include <utility>

#include "coppice/base/check_fields.h"
#include "coppice/tetra/lattice/refinement.h"
#include "coppice/tetra/march/parts_internal.h"
#include "coppice/tetra/march/snapping_internal.h"

namespace coppice {
namespace {

MarchResult march(const TetraMesh& mesh, FieldRef field, const InsideAxes& axes, const MarchOptions& options,
                  bool with_solid, const Context& ctx) {
    check_fields(options, "march");
    const TetraRefinement refinement(mesh, options.levels, ctx);
    ctx.throw_if_cancelled();
    MarchResult out;
    out.report.tetra = refinement.tetra_count();
    out.report.vertices = refinement.vertex_count();
    const tetra_internal::HeldVertices held = tetra_internal::hold_axes(refinement, axes, ctx);
    tetra_internal::Samples samples =
        tetra_internal::sample_vertices(refinement, field, options.snap, held, axes.segments, ctx);
    ctx.throw_if_cancelled();
    out.report.inside = static_cast<std::uint64_t>(
        std::ranges::count_if(samples.height, [](float height) { return height > 0; }));
    out.open = tetra_internal::open_faces(refinement, samples.inside, with_solid, ctx);
    if (!out.open.empty()) return out;
    const std::uint32_t near = samples.on.count();
    const tetra_internal::SnappedVertices kept = tetra_internal::unsnap_vertices(refinement, samples, ctx);
    ctx.throw_if_cancelled();
    out.report.snapped = samples.on.count();
    out.report.freed = near - out.report.snapped;
    tetra_internal::ExtractedSurface surface =
        tetra_internal::extract(refinement, field, samples, kept, options.refinements, with_solid, ctx);
    out.mesh = std::move(surface.mesh);
    out.solid = std::move(surface.solid);
    out.report.crossed = surface.crossed;
    if (!axes.segments.empty()) {
        const std::vector<Vec3> places = tetra_internal::held_places(refinement, held, samples);
        const tetra_internal::DroppedParts dropped =
            tetra_internal::drop_parts(out.mesh, places, !with_solid, ctx);
        out.report.dropped = dropped.count;
        tetra_internal::drop_bodies(out.solid, dropped);
    }
    tetra_internal::compact(out.solid);
    return out;
}

}  // namespace

MarchResult march(const TetraMesh& mesh, FieldRef field, const MarchOptions& options, const Context& ctx) {
    return march(mesh, field, InsideAxes{{}, {}}, options, false, ctx);
}

MarchResult march(const TetraMesh& mesh, FieldRef field, const InsideAxes& axes, const MarchOptions& options,
                  const Context& ctx) {
    return march(mesh, field, axes, options, false, ctx);
}

MarchResult march_solid(const TetraMesh& mesh, FieldRef field, const InsideAxes& axes,
                        const MarchOptions& options, const Context& ctx) {
    return march(mesh, field, axes, options, true, ctx);
}

}  // namespace coppice
