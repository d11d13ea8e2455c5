#pragma once

#include "coppice/pipeline/mesh_skeleton.h"
#include "coppice/skeleton/skeleton.h"

namespace coppice {

/// Returns the approximate maximum memory [bytes] of mesh_skeleton(), including the returned surface. O(n).
double memory_of_mesh(const Skeleton& skeleton, const MeshOptions& options);

/// Returns the approximate maximum memory [bytes] for creating a surface of this number of quads.
double memory_of_faces(double quads, Fit fit);

}  // namespace coppice
