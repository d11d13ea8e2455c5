#pragma once

#include "coppice/field/field_options.h"
#include "gpu_case.h"

namespace coppice::bench {

/// How fast a field is summed up.
struct PairsResult {
    std::string kernel;
    double pairs = 0;     ///< of points and segments, in one round
    double seconds = -1;  ///< on the card
    double flops_per_pair = 0;
    double cpu_rate = 0;  ///< [1/s] pairs on all threads of the CPU
};

/// Value and gradient at many points, each of the same segments, with the field's own code.
PairsResult measure_pairs(Kernel kernel, const GpuRun& run);

nlohmann::ordered_json json_of(const PairsResult& result, const DeviceSearch& device);
std::string markdown_of(const std::vector<PairsResult>& results, const DeviceSearch& device);

}  // namespace coppice::bench
