#pragma once

#include <span>
#include <vector>

#include "coppice/base/context.h"
#include "coppice/render/image.h"

namespace coppice {

/// How numbers become colours and lines.
struct HeightMapOptions {
    double low = 0;                     ///< drawn in dark blue, as what is less
    double high = 1;                    ///< drawn in pale yellow, as what is greater; > low
    std::vector<double> isolines = {};  ///< a fine dark line where the numbers pass one of these
    std::vector<double> outlines = {};  ///< a broad white line
};

/// Draws a table of numbers as a map: dark blue, blue, green, yellow, pale yellow, with lines of equal number
/// between pixels. What is not a number is grey. `values` are rows of `width` from the top. O(pixels), and
/// lines where they pass. Throws Cancelled.
Image height_map(std::span<const double> values, int width, const HeightMapOptions& options,
                 const Context& ctx = {});

/// Draws a filled white dot with a dark rim, its centre at x, y [pixels] from the upper left corner.
void draw_dot(Image& image, double x, double y, double radius);

}  // namespace coppice
