#include "coppice/pipeline/quads/quad_build.h"

#include <utility>

#include "coppice/base/error.h"
#include "coppice/pipeline/field_regions_internal.h"
#include "coppice/pipeline/quads/built_mesh_internal.h"

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

std::vector<std::uint32_t> RemeshTrace::kept_vertices(std::uint32_t count) const {
    std::vector<std::uint32_t> out;
    out.reserve(count - gone.size());
    auto next_gone = gone.begin();
    for (std::uint32_t v = 0; v < count; ++v) {
        if (next_gone != gone.end() && *next_gone == v) {
            ++next_gone;
        } else {
            out.push_back(v);
        }
    }
    return out;
}

QuadBuild build_quads(const Skeleton& skeleton, const MeshOptions& options, const Context& ctx) {
    return pipeline_internal::build_mesh(skeleton, plain_quads(options), ctx).build;
}

void set_regions(ConvolutionField& field, const QuadBuild& build, const Context& ctx) {
    field.set_regions(pipeline_internal::field_regions(build.cage, build.skeleton), {build.tubes, build.tube},
                      ctx);
}

}  // namespace coppice
