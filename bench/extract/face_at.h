#pragma once

#include <cstdint>

#include "coppice/base/vec.h"
#include "coppice/measure/surface_tree.h"

namespace coppice::bench {

/// Returns the face of a mesh that is closest to a point. O(log n).
std::uint32_t face_at(const SurfaceTree& tree, Vec3d p);

}  // namespace coppice::bench
