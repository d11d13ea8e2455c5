#pragma once

#include <string>
#include <vector>

#include "scene_bench.h"

namespace coppice::bench {

/// What all results of one run of the program have in common.
struct RunInfo {
    std::string machine;
    unsigned threads = 0;
    int levels = 0;
};

/// The main figures, one row per scene, then the seconds of every stage, as Markdown tables.
std::string markdown_report(const RunInfo& run, const std::vector<SceneResult>& results);

/// One line per scene and measure: scene, segments, threads, levels, quads, hash, measure, median, least,
/// runs.
std::string csv_report(const RunInfo& run, const std::vector<SceneResult>& results);

/// Everything, every sample included.
std::string json_report(const RunInfo& run, const std::vector<SceneResult>& results);

}  // namespace coppice::bench
