#pragma once

#include <filesystem>
#include <string>
#include <vector>

namespace coppice::cli {

/// A line of a chart, or its bars of one colour.
struct ChartSeries {
    std::string name;                               ///< for the legend
    std::vector<std::pair<double, double>> values;  ///< x and y; of bars x is the number of the category
};

/// A diagram with axes from 0, lines or bars.
struct Chart {
    std::string title, x_label, y_label;
    std::vector<std::string> categories;  ///< of bars, along x; none for lines
    std::vector<ChartSeries> series;      ///< drawn in this order; with several a legend tells them apart
    int width = 800, height = 500;        ///< [pixels]
};

/// Whether the name ends in .svg or .png, in any case.
bool is_chart_name(const std::filesystem::path& path);

/// Writes the chart as SVG or PNG by the ending of the name; the file appears whole or not at all. Values
/// that are not finite are left out. Throws IoError.
void write_chart(const std::filesystem::path& path, const Chart& chart);

}  // namespace coppice::cli
