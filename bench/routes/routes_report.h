#pragma once

#include <optional>
#include <string>
#include <vector>

#include "routes_bench.h"

namespace coppice::bench {

/// All measurements of one run of the program.
struct Comparison {
    std::string machine;
    unsigned threads = 0;
    std::vector<PaperTree> papers;
    std::vector<RoutesResult> paper_trees;  ///< one for each of `papers`
    std::vector<RoutesResult> scenes;
    std::optional<RoutesResult> twigs;
};

/// Returns tables as Markdown, with a line above each that describes it.
std::string comparison_markdown(const Comparison& all);

/// Returns a line per scene, route and stage.
std::string comparison_csv(const Comparison& all);

/// Returns all results, including every sample.
std::string comparison_json(const Comparison& all);

}  // namespace coppice::bench
