#pragma once

#include "coppice/pipeline/mesh_options.h"
#include "coppice/pipeline/mesh_result.h"
#include "coppice/pipeline/stages_internal.h"
#include "coppice/points/point_set.h"
#include "coppice/skeleton/skeleton.h"

namespace coppice {

/// Returns the surface of the field of a prepared skeleton by tetrahedra; sets the weights, if requested, and
/// the stages.
TetraSurface mesh_by_tetrahedra(const Skeleton& prepared, const PointSet& constraints,
                                const MeshOptions& options, std::optional<GlobalWeights>& weights,
                                const Context& ctx, Stages& stages);

/// The same with the tetrahedra inside.
TetraSurface solid_by_tetrahedra(const Skeleton& prepared, const PointSet& constraints,
                                 const MeshOptions& options, std::optional<GlobalWeights>& weights,
                                 const Context& ctx, Stages& stages);

}  // namespace coppice
