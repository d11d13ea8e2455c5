#pragma once

#include <cstdint>
#include <filesystem>
#include <string>
#include <vector>

#include "coppice/base/context.h"
#include "measure.h"
#include "scenes.h"

namespace coppice::bench {

struct BenchOptions {
    /// maximum number of timed runs of a scene; fewer if they would take longer than `seconds`
    int repeat = 9;
    double seconds = 20;                       ///< [s] per scene for the timed runs; at least three are made
    int levels = 2;                            ///< of subdivision
    int samples = 16;                          ///< rays per pixel of the image
    std::uint64_t largest_output = 3'000'000;  ///< [quads] maximum size of meshes that are written and drawn
    std::filesystem::path folder;              ///< folder of temporary files
};

struct SceneResult {
    std::string scene;
    std::uint64_t segments = 0, cage_quads = 0, quads = 0, vertices = 0;
    std::uint64_t hash = 0;        ///< of positions and quads, equal in every run
    std::uint64_t peak_bytes = 0;  ///< peak memory above the input
    std::vector<Measure> measures;

    const Measure* find(const std::string& name) const;  ///< null if it was not measured
    double bytes_per_quad() const { return static_cast<double>(peak_bytes) / static_cast<double>(quads); }
    double microseconds_per_segment() const;
    double ratio_to_opensubdiv() const;  ///< median of mesh / median of opensubdiv
};

/// Measures one scene: an untimed warm-up run, which also determines the memory, then alternately the way
/// from skeleton to quads and OpenSubdiv's refinement of the same cage, then writing and drawing. Throws
/// Error if two runs differ.
SceneResult bench_scene(const Scene& scene, const BenchOptions& options, const Context& ctx);

}  // namespace coppice::bench
