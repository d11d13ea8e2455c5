#pragma once

#include "coppice/field/field_options.h"
#include "gpu_case.h"

namespace coppice::bench {

/// Throughput of the summation of a field.
struct PairsResult {
    std::string kernel;
    double pairs = 0;     ///< number of pairs of a point and a segment in one round
    double seconds = -1;  ///< on the GPU
    double flops_per_pair = 0;
    double cpu_rate = 0;  ///< [1/s] rate of pairs on all threads of the CPU
};

/// Measures value and gradient at many points, each with the same segments, using the code of the field.
PairsResult measure_pairs(Kernel kernel, const GpuRun& run);

Json make_json(const PairsResult& result, const DeviceSearch& device);
std::string to_markdown(const std::vector<PairsResult>& results, const DeviceSearch& device);

}  // namespace coppice::bench
