#pragma once

#include <string>
#include <vector>

#include "scene_bench.h"

namespace coppice::bench {

/// Common properties of all results of one run of the program.
struct RunInfo {
    std::string machine;
    unsigned threads = 0;
    int levels = 0;
};

/// Returns the main figures, one row per scene, then the seconds of every stage, as Markdown tables.
std::string markdown_report(const RunInfo& run, const std::vector<SceneResult>& results);

/// Returns one line per scene and measure: scene, segments, threads, levels, quads, hash, measure, median,
/// least, runs.
std::string csv_report(const RunInfo& run, const std::vector<SceneResult>& results);

/// Returns all results, including every sample.
std::string json_report(const RunInfo& run, const std::vector<SceneResult>& results);

}  // namespace coppice::bench
