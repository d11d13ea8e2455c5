#pragma once

#include "coppice/base/context.h"
#include "coppice/io/file.h"
#include "coppice/io/points/reader.h"
#include "coppice/points/painted_points.h"

namespace coppice::io_internal {

/// LAS 1.4, see `write_painted_points`: `points`, with the columns of `known`.
void write_las(AtomicFile& file, const PointSet& points, const PaintedPoints& known,
               const CoordinateSystem& system, const Context& ctx);

}  // namespace coppice::io_internal
