#pragma once

#include <cstddef>
#include <string_view>

#include "coppice/base/column.h"
#include "coppice/base/context.h"
#include "coppice/extract/cloud/from_cloud.h"
#include "coppice/extract/plot/terrain.h"

namespace coppice::extract_internal {

/// Throws InvalidInput where fewer points are left than a skeleton needs; `what` says where.
void check_point_count(std::size_t count, std::string_view what);

/// The points of a cloud that can be wood, sorted in space, and the ground under them.
struct CleanCloud {
    Buffer<Vec3> points;
    Terrain terrain;  ///< `is_ground` where points of the ground were removed
};

/// Removes duplicates, downsamples as the options ask, and removes the ground. Counts in `report` what is
/// left out.
CleanCloud clean_cloud(const PointSet& set, const CloudOptions& options, CloudReport& report,
                       const Context& ctx);

}  // namespace coppice::extract_internal
