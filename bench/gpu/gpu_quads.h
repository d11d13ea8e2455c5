#pragma once

#include <vector>

#include "coppice/skeleton/skeleton.h"
#include "gpu_case.h"

namespace coppice::bench {

/// A benchmark case of quads.
struct QuadCase {
    std::string name;
    std::vector<Skeleton> trees;  ///< one tree, or several that are processed at once, each with its own cage
    double papers = -1;           ///< [s] published time for subdivision and approximation
    std::vector<Goal> goals;
    /// whether the method as published in [Zhu2015] is also measured, on the first tree
    bool as_printed = false;
};

/// Measures the work from a cage to quads with normals, entirely on the GPU, and on the CPU; for the
/// published method only subdivision and evolution, on both sides with the same kernels.
std::vector<GpuResult> measure_quads(const QuadCase& what, const GpuRun& run);

}  // namespace coppice::bench
