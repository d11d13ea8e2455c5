#pragma once

#include <vector>

#include "coppice/skeleton/skeleton.h"
#include "gpu_case.h"

namespace coppice::bench {

/// What is measured of quads.
struct QuadCase {
    std::string name;
    std::vector<Skeleton> trees;  ///< one, or several that are made at once, each with a cage of its own
    double papers = -1;           ///< [s] printed for subdivision and approximation
    std::vector<Goal> goals;
    bool as_printed = false;  ///< whether what [Zhu2015] prints is measured beside it, of the first tree
};

/// From a cage on the card to quads, normals and all on the card, and on the CPU; as printed, subdivision and
/// evolution alone, on both sides by the same kernels.
std::vector<GpuResult> measure_quads(const QuadCase& what, const GpuRun& run);

}  // namespace coppice::bench
