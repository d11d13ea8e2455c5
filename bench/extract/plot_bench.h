#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "coppice/extract/plot/plot.h"
#include "plot_truth.h"

namespace coppice::bench {

/// Quality of the segmentation of a plot into trees. Shares in [0, 1].
struct PlotScore {
    std::string plot;
    std::size_t trees = 0, points = 0, wood = 0;  ///< true trees, all points, points on trees
    std::size_t found = 0, wrong = 0;  ///< found trees that match a true one, and those that do not
    double wood_right = 0;             ///< share of the points on trees that are assigned to the right one
    double min_right = 0;              ///< the same for the worst tree
    double given_right = 0;            ///< share of the points assigned to trees that belong to that tree
    double ground_right = 0;           ///< share of the points of the ground that are classified as ground
    double dbh_mean = 0, dbh_bias = 0, dbh_worst = 0;  ///< relative errors of found trees
    double height_mean = 0;                            ///< relative error of heights
    double length = 0, volume = 0;                     ///< of all skeletons, relative to the true ones
    std::size_t failed = 0;                            ///< trees without a skeleton
    double seconds = 0;
    std::uint64_t peak_bytes = 0;
};

/// Compares the result with the truth. A tree is found if a stem is within 0.3 m or its true diameter of it
/// at breast height; each stem matches one tree only.
PlotScore judge_plot(const PlotScene& scene, const PlotExtraction& found);

/// Returns one row per plot.
std::string plot_markdown(const std::vector<PlotScore>& scores);

}  // namespace coppice::bench
