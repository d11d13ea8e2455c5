#pragma once

#include <cstdint>
#include <filesystem>
#include <functional>
#include <string>
#include <vector>

#include "coppice/measure/match/skeleton_match.h"
#include "extract_truth.h"

namespace coppice::bench {

/// Result of one scene.
struct Extraction {
    Skeleton skeleton;
    double seconds = 0;
    std::uint64_t peak_bytes = 0;
};

/// Extracts the skeleton of a scene's input without access to its truth. Throws Error if it fails.
using Extractor = std::function<Extraction(const TruthScene&)>;

/// Runs another program that reads a file and writes a skeleton: {in} and {out} in the command are replaced
/// by the names of files in `folder`. Its time is that of the whole program, including files.
Extractor program_extractor(const std::string& command, const std::filesystem::path& folder,
                            const Context& ctx);

/// Runs Coppice in this process, with its defaults: `extract_from_mesh` or `extract_from_cloud`. The peak is
/// its memory in addition to the input.
Extractor own_extractor(const Context& ctx);

struct TruthResult {
    std::string scene;
    std::size_t input_size = 0;
    bool cloud = false;
    std::string failure;  ///< reason of a failure; the following members are then empty
    std::uint32_t nodes = 0;
    double seconds = 0;
    std::uint64_t peak_bytes = 0;
    SkeletonMatch match;
};

/// Creates the scene, extracts the skeleton, and compares it with the truth.
TruthResult bench_extraction(const TruthScene& scene, const Extractor& extract, const Context& ctx);

/// Returns one row per scene.
std::string extract_markdown(const std::vector<TruthResult>& results, unsigned threads,
                             const std::string& machine);

/// Writes the input of a scene as PLY; returns the file name, which is the name of the scene.
std::filesystem::path write_input(const TruthScene& scene, const std::filesystem::path& folder,
                                  const Context& ctx);

}  // namespace coppice::bench
