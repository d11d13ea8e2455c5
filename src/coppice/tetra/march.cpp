#include "coppice/tetra/march.h"

#include <algorithm>

#include "coppice/base/check_fields.h"
#include "coppice/tetra/march_settle_internal.h"
#include "coppice/tetra/refinement.h"

namespace coppice {

MarchResult march(const TetraMesh& mesh, FieldRef field, const MarchOptions& options, const Context& ctx) {
    check_fields(options, "march");
    const TetraRefinement refinement(mesh, options.levels, ctx);
    ctx.throw_if_cancelled();
    MarchResult out;
    out.report.tetra = refinement.tetra_count();
    out.report.vertices = refinement.vertex_count();
    march_detail::Samples samples = march_detail::sample_vertices(refinement, field, options.snap, ctx);
    ctx.throw_if_cancelled();
    out.open = march_detail::open_faces(refinement, samples.inside, ctx);
    if (!out.open.empty()) return out;
    const march_detail::Settled settled = march_detail::free_vertices(refinement, samples, ctx);
    ctx.throw_if_cancelled();
    out.report.snapped = samples.on.count();
    out.report.freed = samples.place.size() - out.report.snapped;
    out.mesh =
        march_detail::extract(refinement, field, samples, settled, options.refinements, out.report, ctx);
    return out;
}

}  // namespace coppice
