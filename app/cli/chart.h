#pragma once

#include <filesystem>
#include <string>
#include <vector>

namespace coppice::cli {

/// A line of a chart, or its bars of one colour.
struct ChartSeries {
    std::string name;                               ///< name in the legend
    std::vector<std::pair<double, double>> values;  ///< x and y; for bars x is the index of the category
};

/// A diagram of lines or bars with axes that begin at 0.
struct Chart {
    std::string title, x_label, y_label;
    std::vector<std::string> categories;  ///< categories of bars along x; empty for lines
    std::vector<ChartSeries> series;      ///< drawn in this order; two or more have a legend
    int width = 800, height = 500;        ///< [pixels]
};

/// Returns whether the extension is .svg or .png, in any case.
bool is_chart_name(const std::filesystem::path& path);

/// Writes the chart as SVG or PNG, chosen by the extension; the file is complete or not written at all. Omits
/// values that are not finite. Throws IoError.
void write_chart(const std::filesystem::path& path, const Chart& chart);

}  // namespace coppice::cli
