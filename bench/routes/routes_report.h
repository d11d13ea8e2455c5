#pragma once

#include <optional>
#include <string>
#include <vector>

#include "routes_bench.h"

namespace coppice::bench {

/// All that one run of the program has measured.
struct Comparison {
    std::string machine;
    unsigned threads = 0;
    std::vector<PaperTree> papers;
    std::vector<RoutesResult> paper_trees;  ///< one for each of `papers`
    std::vector<RoutesResult> scenes;
    std::optional<RoutesResult> twigs;
};

/// Tables as Markdown, with a line above each that says what it shows.
std::string comparison_markdown(const Comparison& all);

/// A line per scene, route and stage.
std::string comparison_csv(const Comparison& all);

/// Everything, every sample included.
std::string comparison_json(const Comparison& all);

}  // namespace coppice::bench
