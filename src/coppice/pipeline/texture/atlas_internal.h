#pragma once

#include "coppice/base/context.h"
#include "coppice/mesh/face_view.h"
#include "coppice/mesh/texture.h"
#include "coppice/pipeline/mesh_result.h"

namespace coppice::pipeline_internal {

/// Texture coordinates in the unit square.
struct Atlas {
    Texture texture;     ///< density relative to the mean
    AtlasReport report;  ///< number of charts and use of the square
};

/// Replaces bark coordinates of one tile around each branch by an atlas: coordinates in the unit square, with
/// no two faces that overlap, and no face that is turned over; two pixels of an image of `size` x `size` are
/// between charts. The whole check is exact. Throws InvalidInput if the charts do not fit. O(n log n).
Atlas make_atlas(const FaceView& mesh, const Texture& bark, int size, const Context& ctx);

}  // namespace coppice::pipeline_internal
