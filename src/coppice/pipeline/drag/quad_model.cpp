#include "coppice/pipeline/drag/quad_model.h"

#include <utility>

#include "coppice/base/error.h"
#include "coppice/pipeline/field_regions_internal.h"
#include "coppice/pipeline/quads/quad_origin_internal.h"
#include "coppice/pipeline/quads/quad_surface_internal.h"
#include "coppice/pipeline/surface_field_internal.h"

namespace coppice {
namespace {

MeshOptions plain_quads(const MeshOptions& given) {
    if (given.method != MeshMethod::quads && given.method != MeshMethod::bmesh)
        throw InvalidInput("mesh: method must be quads or bmesh for a surface with dragged branches");
    if (given.field.weights != Weights::local)
        throw InvalidInput("mesh: weights must be local for a surface with dragged branches");
    if (given.fit == Fit::volume)
        throw InvalidInput("mesh: fit must not be volume for a surface with dragged branches");
    MeshOptions options = given;
    // Merged branches would separate while they are dragged.
    if (options.overlaps == Overlaps::merge) options.overlaps = Overlaps::graft;
    options.untangle.passes = 0;
    options.remesh_rounds = 0;
    options.device = Device::cpu;  // frames computed on the CPU return to these bits
    return options;
}

}  // namespace

QuadModel quad_model(const Skeleton& skeleton, const MeshOptions& given, const Context& ctx) {
    const MeshOptions options = plain_quads(given);
    pipeline_internal::QuadOrigin origin;
    MeshResult made = pipeline_internal::mesh_with_origin(skeleton, options, origin, ctx);
    const MeshOptions meant = options.method == MeshMethod::bmesh ? on_metaballs(options) : options;
    return {.options = meant,
            .field = surface_field_options(meant),
            .control = std::move(made.quads().cage),
            .rest = std::move(origin.rows.mesh),
            .skeleton = std::move(origin.field),
            .tubes = std::move(origin.rows.tubes),
            .tube = std::move(origin.tube)};
}

void set_regions(ConvolutionField& field, const QuadModel& model, const Context& ctx) {
    field.set_regions(pipeline_internal::field_regions(model.control, model.skeleton),
                      {model.tubes, model.tube}, ctx);
}

}  // namespace coppice
