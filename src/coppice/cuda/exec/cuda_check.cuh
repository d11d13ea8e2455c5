#pragma once

#include <cuda_runtime.h>

#include <string>

#include "coppice/cuda/device.h"

namespace coppice::cuda {

/// Throws DeviceError that says what failed, and why; DeviceFull where it is for want of memory.
inline void check(cudaError_t error, const char* what) {
    if (error == cudaSuccess) return;
    cudaGetLastError();  // it is told of once
    const std::string said =
        std::string("the CUDA device failed to ") + what + ": " + cudaGetErrorString(error);
    if (error == cudaErrorMemoryAllocation) throw DeviceFull(said);
    throw DeviceError(said);
}

}  // namespace coppice::cuda
