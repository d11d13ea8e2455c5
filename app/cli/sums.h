#pragma once

#include <functional>
#include <string>
#include <string_view>

#include "coppice/base/context.h"
#include "coppice/io_skeleton/reader.h"
#include "coppice/skeleton/measure.h"
#include "figures.h"

namespace coppice::cli {

/// Adds volumes and areas: the sum over the segments of a skeleton, their union, and the cylinders stored in
/// its file. `name` appends the unit to the name of a figure, for the given power of a length.
void add_sums(Json& out, const SkeletonFile& file, const SkeletonMeasures& measures,
              const std::function<std::string(std::string_view name, int power)>& name, const Context& ctx);

}  // namespace coppice::cli
