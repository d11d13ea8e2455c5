#pragma once

#include <cstdint>
#include <span>

#include "coppice/base/context.h"
#include "coppice/pipeline/mesh_result.h"
#include "coppice/pipeline/quads/quad_build.h"

namespace coppice::pipeline_internal {

/// Returns bark coordinates for the corners of a surface of quads; see TubeTexture for those of tubes. Quads
/// that replaced tubes at intersections get the coordinates of the closest tube. Caps, and quads that would
/// be turned over or distorted by more than a factor of four, are projected on a plane each. O(n log n).
Texture bark_texture(const QuadMesh& mesh, const QuadBuild& build, const TextureOptions& options,
                     const Context& ctx);

/// Returns the same for a surface of triangles: the coordinates of the closest quads of `build`.
Texture bark_texture(const TriMesh& mesh, const QuadBuild& build, const TextureOptions& options,
                     const Context& ctx);

}  // namespace coppice::pipeline_internal
