#pragma once

#include "coppice/base/context.h"
#include "coppice/measure/cone_union.h"
#include "coppice/measure/volume_report.h"
#include "coppice/mesh/face_view.h"

namespace coppice::pipeline_internal {

/// Returns the volume of a closed surface and the volume of the union of its skeleton's rounded cones, by
/// about 2^15 points, without a search for missing parts. `solid` has to be in the mesh's frame.
VolumeReport measured_volume(const FaceView& mesh, const ConeUnion& solid, const Context& ctx);

}  // namespace coppice::pipeline_internal
