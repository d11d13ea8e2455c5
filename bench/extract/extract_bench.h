#pragma once

#include <cstdint>
#include <filesystem>
#include <functional>
#include <string>
#include <vector>

#include "coppice/measure/match/skeleton_match.h"
#include "extract_truth.h"

namespace coppice::bench {

/// What came of one scene.
struct Extraction {
    Skeleton skeleton;
    double seconds = 0;
    std::uint64_t peak_bytes = 0;
};

/// Finds the skeleton of a scene's input without looking at its truth. Throws Error when it fails.
using Extractor = std::function<Extraction(const TruthScene&)>;

/// Another program that reads a file and writes a skeleton: the words {in} and {out} of the command are
/// replaced by the names of files in `folder`. Its time is that of the whole program, files included.
Extractor program_extractor(const std::string& command, const std::filesystem::path& folder,
                            const Context& ctx);

/// Coppice itself, in this process, with its defaults: `extract_from_mesh` or `extract_from_cloud`. The peak
/// is what it needs beside the input.
Extractor own_extractor(const Context& ctx);

struct TruthResult {
    std::string scene;
    std::size_t input_size = 0;
    bool cloud = false;
    std::string failure;  ///< why nothing was found; then what follows is empty
    std::uint32_t nodes = 0;
    double seconds = 0;
    std::uint64_t peak_bytes = 0;
    SkeletonMatch match;
};

/// Makes the scene, extracts, and holds what was found against the truth.
TruthResult bench_extraction(const TruthScene& scene, const Extractor& extract, const Context& ctx);

/// One row a scene.
std::string extract_markdown(const std::vector<TruthResult>& results, unsigned threads,
                             const std::string& machine);

/// Writes the input of a scene as PLY; returns the name of the file, that of the scene.
std::filesystem::path write_input(const TruthScene& scene, const std::filesystem::path& folder,
                                  const Context& ctx);

}  // namespace coppice::bench
