#pragma once

#include "coppice/base/context.h"
#include "coppice/io_skeleton/reader.h"
#include "coppice/skeleton/measure.h"
#include "files.h"

namespace coppice::cli {

/// Adds volumes and areas: the sum over the segments of a skeleton, their union, and the cylinders stored in
/// its file. `name` appends the unit to the name of a figure, for the given power of a length.
void add_sums(Json& out, const SkeletonFile& file, const SkeletonMeasures& measures, const FigureName& name,
              const Context& ctx);

}  // namespace coppice::cli
