#pragma once

#include "coppice/pipeline/fit/limit_offsets_internal.h"
#include "coppice/pipeline/fit_volume.h"

namespace coppice::pipeline_internal {

/// The same as coppice::fit_volume, with a search for crossings that uses the structure of the mesh.
FitVolumeReport fit_volume(QuadMesh& mesh, const Skeleton& skeleton, EndShape base, EndShape tips,
                           const CrossingSearch& search, const Context& ctx);

}  // namespace coppice::pipeline_internal
