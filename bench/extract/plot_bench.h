#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "coppice/extract/plot/plot.h"
#include "plot_truth.h"

namespace coppice::bench {

/// How well the trees of a plot were told apart. Shares in [0, 1].
struct PlotScore {
    std::string plot;
    std::size_t trees = 0, points = 0, wood = 0;  ///< true trees, all points, those on trees
    std::size_t found = 0, wrong = 0;             ///< trees that stand where one is, and those where none is
    double wood_right = 0;                        ///< of the points on trees, given to the right one
    double least_right = 0;                       ///< the same of the tree that fared worst
    double given_right = 0;                       ///< of the points given to trees, those of that tree
    double ground_right = 0;                      ///< of the points of the ground, taken for it
    double dbh_mean = 0, dbh_bias = 0, dbh_worst = 0;  ///< relative errors of trees that were found
    double height_mean = 0;                            ///< the same of heights
    double length = 0, volume = 0;                     ///< of all skeletons, over the true ones
    std::size_t failed = 0;                            ///< trees without a skeleton
    double seconds = 0;
    std::uint64_t peak_bytes = 0;
};

/// Holds what was found against the truth. A tree is found where a stem stands within 0.3 m or its own true
/// diameter of it at breast height, each for one tree only.
PlotScore judge_plot(const PlotScene& scene, const PlotExtraction& found);

/// One row a plot.
std::string plot_markdown(const std::vector<PlotScore>& scores);

}  // namespace coppice::bench
