#pragma once

#include <span>
#include <vector>

#include "coppice/base/context.h"
#include "coppice/render/image.h"

namespace coppice {

/// Colours and lines of a map.
struct HeightMapOptions {
    double low = 0;                     ///< dark blue, also for lower values
    double high = 1;                    ///< pale yellow, also for higher values; > low
    std::vector<double> isolines = {};  ///< values of fine dark isolines
    std::vector<double> outlines = {};  ///< values of broad white isolines
};

/// Draws a table of values as a map: dark blue, blue, green, yellow, pale yellow, with isolines at subpixel
/// accuracy. NaN is grey. `values` are rows of `width` from the top. O(pixels), plus the length of the lines.
/// Throws Cancelled.
Image height_map(std::span<const double> values, int width, const HeightMapOptions& options,
                 const Context& ctx = {});

/// Draws a filled white dot with a dark rim and its centre at x, y [pixels] from the upper left corner.
void draw_dot(Image& image, double x, double y, double radius);

}  // namespace coppice
