#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "coppice/base/context.h"
#include "coppice/pipeline/mesh_result.h"
#include "coppice/pipeline/quads/quad_build.h"

namespace coppice::pipeline_internal {

/// Bark coordinates of a surface.
struct BarkTexture {
    Texture texture;
    /// [m] per face the maximum radius of its branch from there to all its tips, if slots.twigs: constant
    /// around tubes, and decreasing along them; negative where it is unknown; otherwise empty
    std::vector<float> radii;
};

/// Returns bark coordinates for the corners of a surface of quads; see TubeTexture for those of tubes. Quads
/// that replaced tubes at intersections get the coordinates of the closest tube. Caps, and quads that would
/// be turned over or distorted by more than a factor of four, are projected on a plane each. O(n log n).
BarkTexture bark_texture(const QuadMesh& mesh, const QuadBuild& build, const TextureOptions& options,
                         const SlotOptions& slots, const Context& ctx);

/// Returns the same for a surface of triangles: the coordinates of the closest quads of `build`.
BarkTexture bark_texture(const TriMesh& mesh, const QuadBuild& build, const TextureOptions& options,
                         const SlotOptions& slots, const Context& ctx);

}  // namespace coppice::pipeline_internal
