#pragma once

#include <cuda_runtime.h>

#include <string>

#include "coppice/cuda/device.h"

namespace coppice::cuda {

/// Throws DeviceError with the failed action and the reason; DeviceFull if there is not enough memory.
inline void check(cudaError_t error, const char* action) {
    if (error == cudaSuccess) return;
    cudaGetLastError();  // clears the error, which is reported here
    const std::string said =
        std::string("the CUDA device failed to ") + action + ": " + cudaGetErrorString(error);
    if (error == cudaErrorMemoryAllocation) throw DeviceFull(said);
    throw DeviceError(said);
}

}  // namespace coppice::cuda
