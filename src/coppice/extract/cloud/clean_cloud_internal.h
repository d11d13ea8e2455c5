#pragma once

#include <cstddef>
#include <string_view>

#include "coppice/base/column.h"
#include "coppice/base/context.h"
#include "coppice/extract/cloud/from_cloud.h"

namespace coppice::extract_internal {

/// Throws InvalidInput where fewer points are left than a skeleton needs; `what` says where.
void check_point_count(std::size_t count, std::string_view what);

/// The points of a cloud that can be wood, sorted in space: without duplicates, downsampled as the options
/// ask, without ground. Counts in `report` what is left out.
Buffer<Vec3> clean_cloud(const PointSet& set, const CloudOptions& options, CloudReport& report,
                         const Context& ctx);

}  // namespace coppice::extract_internal
