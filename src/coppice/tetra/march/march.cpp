#include "coppice/tetra/march/march.h"

#include <utility>

#include "coppice/base/check_fields.h"
#include "coppice/tetra/lattice/refinement.h"
#include "coppice/tetra/march/snapping_internal.h"

namespace coppice {

MarchResult march(const TetraMesh& mesh, FieldRef field, const MarchOptions& options, const Context& ctx) {
    check_fields(options, "march");
    const TetraRefinement refinement(mesh, options.levels, ctx);
    ctx.throw_if_cancelled();
    MarchResult out;
    out.report.tetra = refinement.tetra_count();
    out.report.vertices = refinement.vertex_count();
    tetra_internal::Samples samples = tetra_internal::sample_vertices(refinement, field, options.snap, ctx);
    ctx.throw_if_cancelled();
    out.open = tetra_internal::open_faces(refinement, samples.inside, ctx);
    if (!out.open.empty()) return out;
    const tetra_internal::SnappedVertices kept = tetra_internal::unsnap_vertices(refinement, samples, ctx);
    ctx.throw_if_cancelled();
    out.report.snapped = samples.on.count();
    out.report.freed = samples.place.size() - out.report.snapped;
    tetra_internal::ExtractedSurface surface =
        tetra_internal::extract(refinement, field, samples, kept, options.refinements, ctx);
    out.mesh = std::move(surface.mesh);
    out.report.crossed = surface.crossed;
    return out;
}

}  // namespace coppice
