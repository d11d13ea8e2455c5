#pragma once

#include <functional>
#include <string>
#include <string_view>

#include "coppice/base/context.h"
#include "coppice/io/skeleton/reader.h"
#include "coppice/skeleton/measure.h"
#include "figures.h"

namespace coppice::cli {

/// Adds volumes and areas: of the segments of a skeleton one by one, of their union, and of the cylinders
/// that its file states. `name` completes the name of a figure that is the given power of a length.
void add_sums(Figures& out, const SkeletonFile& file, const SkeletonMeasures& measures,
              const std::function<std::string(std::string_view name, int power)>& name, const Context& ctx);

}  // namespace coppice::cli
