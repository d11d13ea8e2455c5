#pragma once

#include "coppice/pipeline/mesh_skeleton.h"
#include "coppice/skeleton/skeleton.h"

namespace coppice {

/// [bytes] that mesh_skeleton() takes at most, about, with the surface that it returns. O(n).
double memory_of_mesh(const Skeleton& skeleton, const MeshOptions& options);

/// [bytes] that making a surface of so many quads takes at most, about.
double memory_of_faces(double quads, Fit fit);

}  // namespace coppice
