#pragma once

#include <cuda_runtime.h>

#include <string>

#include "coppice/cuda/device.h"

namespace coppice::cuda {

/// Throws DeviceError that says what failed, and why.
inline void check(cudaError_t error, const char* what) {
    if (error == cudaSuccess) return;
    cudaGetLastError();  // it is told of once
    throw DeviceError(std::string("the CUDA device failed to ") + what + ": " + cudaGetErrorString(error));
}

}  // namespace coppice::cuda
