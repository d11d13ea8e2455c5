#include "coppice/measure/union_volume.h"
#include "coppice/mesh/shape.h"
#include "coppice/pipeline/fit/measured_volume_internal.h"

namespace coppice::pipeline_internal {

VolumeReport measured_volume(const FaceView& mesh, const ConeUnion& solid, const Context& ctx) {
    constexpr std::uint64_t kSamples = 1 << 15;
    const VolumeEstimate cones = estimate_union_volume(solid, kSamples, ctx);
    return {.mesh = signed_volume(mesh, ctx), .cones = cones.volume, .error = cones.error};
}

}  // namespace coppice::pipeline_internal
