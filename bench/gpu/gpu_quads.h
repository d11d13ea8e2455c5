#pragma once

#include "coppice/skeleton/skeleton.h"
#include "gpu_case.h"

namespace coppice::bench {

/// What is measured of quads, with what the papers print for it and what it should take.
struct QuadCase {
    std::string name;
    Skeleton skeleton;
    double papers = -1, goal = -1;  ///< [s]
};

/// From a cage on the card to quads, normals and all on the card, and on the CPU.
GpuResult measure_quads(const QuadCase& what, const GpuRun& run);

}  // namespace coppice::bench
