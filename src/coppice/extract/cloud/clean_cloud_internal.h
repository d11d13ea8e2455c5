#pragma once

#include <cstddef>
#include <string_view>

#include "coppice/base/column.h"
#include "coppice/base/context.h"
#include "coppice/extract/cloud/from_cloud.h"
#include "coppice/extract/plot/terrain.h"
#include "coppice/extract/points/cloud_frame_internal.h"

namespace coppice::extract_internal {

/// Throws InvalidInput if fewer points are left than a skeleton needs; `subject` completes the message.
void check_point_count(std::size_t count, std::string_view subject);

/// Points of a cloud that can be wood, spatially sorted, and the ground under them, in the frame of the
/// cloud.
struct CleanCloud {
    Buffer<Vec3> points;
    CloudFrame frame;
    Terrain terrain;  ///< `is_ground` if ground points were removed
};

/// Removes duplicates, downsamples according to the options, and removes the ground. Counts the removed
/// points in `report`.
CleanCloud clean_cloud(const PointSet& set, const CloudOptions& options, CloudReport& report,
                       const Context& ctx);

}  // namespace coppice::extract_internal
