#pragma once

#include "coppice/base/context.h"
#include "coppice/io_points/reader.h"
#include "coppice/points/point_cloud.h"
#include "coppice/system/file.h"

namespace coppice::io_internal {

/// Writes LAS 1.4, see `write_point_cloud`: `points` with the columns of `known`.
void write_las(AtomicFile& file, const PointSet& points, const PointCloud& known,
               const CoordinateSystem& system, const Context& ctx);

}  // namespace coppice::io_internal
