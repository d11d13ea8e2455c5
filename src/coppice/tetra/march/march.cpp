#include "coppice/tetra/march/march.h"

#include <utility>

#include "coppice/base/check_fields.h"
#include "coppice/base/option_fields.h"
#include "coppice/tetra/lattice/refinement.h"
#include "coppice/tetra/march/components_internal.h"
#include "coppice/tetra/march/snapping_internal.h"

namespace coppice {
namespace tetra_internal {
namespace {

/// Input and options of a march.
struct Task {
    const TetraMesh& mesh;
    FieldRef field;
    const InsideAxes& axes;
    const MarchOptions& options;
    bool with_solid;
};

/// Moves vertices back and creates the surface.
void extract(const Task& task, const TetraRefinement& refinement, Samples& samples, MarchResult& out,
             const Context& ctx) {
    const SnappedVertices kept = unsnap_vertices(refinement, samples, ctx);
    ctx.throw_if_cancelled();
    ExtractedSurface surface =
        extract(refinement, task.field, samples, kept, task.options.refinements, task.with_solid, ctx);
    out.report.crossed = surface.crossed;
    out.mesh = std::move(surface.mesh);
    out.solid = std::move(surface.solid);
}

void drop_unheld(const Task& task, const TetraRefinement& refinement, const Samples& samples,
                 const HeldVertices& held, MarchResult& out, const Context& ctx) {
    const std::vector<Vec3> places = held_places(refinement, held, samples);
    const RemovedComponents dropped = drop_parts(out.mesh, places, !task.with_solid, ctx);
    out.report.dropped = dropped.count;
    drop_bodies(out.solid, dropped);
}

MarchResult march(const Task& task, const Context& ctx) {
    check(task.options);
    const TetraRefinement refinement(task.mesh, task.options.levels, ctx);
    ctx.throw_if_cancelled();
    MarchResult out;
    out.report.tetra = refinement.tetra_count();
    out.report.vertices = refinement.vertex_count();
    const HeldVertices held = hold_axes(refinement, task.axes, ctx);
    Samples samples =
        sample_vertices(refinement, task.field, task.options.snap, held, task.axes.segments, ctx);
    ctx.throw_if_cancelled();
    out.report.inside = samples.above.count();
    out.open = open_faces(refinement, samples.inside, task.with_solid, ctx);
    if (!out.open.empty()) return out;
    const std::uint32_t near = samples.on.count();
    extract(task, refinement, samples, out, ctx);
    out.report.snapped = samples.on.count();
    out.report.freed = near - out.report.snapped;
    if (!task.axes.segments.empty()) drop_unheld(task, refinement, samples, held, out, ctx);
    compact(out.solid);
    return out;
}

}  // namespace
}  // namespace tetra_internal

void check(const MarchOptions& options) { check_fields(options, "march"); }

MarchResult march(const TetraMesh& mesh, FieldRef field, const MarchOptions& options, const Context& ctx) {
    return tetra_internal::march({mesh, field, InsideAxes{{}, {}}, options, false}, ctx);
}

MarchResult march(const TetraMesh& mesh, FieldRef field, const InsideAxes& axes, const MarchOptions& options,
                  const Context& ctx) {
    return tetra_internal::march({mesh, field, axes, options, false}, ctx);
}

MarchResult march_solid(const TetraMesh& mesh, FieldRef field, const InsideAxes& axes,
                        const MarchOptions& options, const Context& ctx) {
    return tetra_internal::march({mesh, field, axes, options, true}, ctx);
}

void list_accuracy_fields(MarchOptions& o, FieldList& list) {
    list.add(
        Field{"snap", "Fraction of an edge within which corners of tetrahedra are moved onto the surface.",
              Unit::none, 0, 0.5},
        o.snap);
    list.add(
        Field{"refinements", "Number of corrections that move a vertex along its edge towards the surface.",
              Unit::none, 0, 20},
        o.refinements);
}

void list_fields(MarchOptions& o, FieldList& list) {
    list.add(Field{"levels", "Number of subdivisions of every tetrahedron into eight.", Unit::none, 0, 5},
             o.levels);
    list_accuracy_fields(o, list);
}

}  // namespace coppice
