#pragma once

#include <cstdint>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "coppice/base/context.h"
#include "coppice/cuda/device.h"
#include "coppice/cuda/exec/kernel_time.h"

namespace coppice::bench {

/// What all cases of one run have in common.
struct GpuRun {
    DeviceSearch device;  ///< the card, or why there is none: then only the CPU is measured
    int repeat = 51;      ///< timed rounds of each case, after a few that are not
    Context ctx;          ///< of the CPU
};

/// What one kernel of a case does in a round, counted by hand.
struct KernelCost {
    std::string name;
    double bytes = 0;  ///< read and written once each
    double flops = 0;  ///< a fused product and sum are two
};

/// One kernel of a case as measured.
struct KernelShare {
    std::string name;
    double seconds = 0;  ///< of all its launches in a round
    std::uint32_t launches = 0;
    KernelCost cost;
};

/// One row of the tables. Times are medians; below 0: not measured.
struct GpuResult {
    std::string name;
    std::uint64_t segments = 0, faces = 0;
    double papers = -1;     ///< [s] printed for the same work
    double goal = -1;       ///< [s]
    double device = -1;     ///< [s] from the cage on the card to the surface on the card
    double with_cage = -1;  ///< [s] from the skeleton on the host to the surface on the card
    double cpu = -1;        ///< [s] of the same stages as `device` on all threads of the CPU
    double bytes_per_face = -1;
    std::int64_t apart = -1;  ///< vertices farther than 1e-4 of the local radius from where the CPU has them
    std::vector<KernelShare> kernels;
};

/// Sums up launches by the kernel, and puts the costs beside them. `rounds` were measured.
std::vector<KernelShare> shares_of(const std::vector<cuda::KernelTime>& times, int rounds,
                                   const std::vector<KernelCost>& costs);

nlohmann::ordered_json json_of(const GpuResult& result, const DeviceSearch& device);
std::string markdown_of(const std::vector<GpuResult>& results, const DeviceSearch& device);

}  // namespace coppice::bench
