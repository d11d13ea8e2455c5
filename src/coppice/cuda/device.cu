#include "coppice/cuda/device.h"

#include "coppice/cuda/exec/cuda_check.cuh"

namespace coppice {

bool has_cuda() { return true; }

DeviceSearch find_device() {
    DeviceSearch out;
    const auto failed = [&](cudaError_t error) {
        cudaGetLastError();
        if (error != cudaSuccess) out.missing = cudaGetErrorString(error);
        return error != cudaSuccess;
    };
    int count = 0;
    if (failed(cudaGetDeviceCount(&count))) return out;
    if (count == 0) {
        out.missing = "CUDA finds no device";
        return out;
    }
    cudaDeviceProp properties{};
    std::size_t free = 0, all = 0;
    if (failed(cudaSetDevice(0)) || failed(cudaGetDeviceProperties(&properties, 0)) ||
        failed(cudaMemGetInfo(&free, &all))) {
        return out;
    }
    out.device = DeviceInfo{properties.name, 10 * properties.major + properties.minor,
                            static_cast<std::uint32_t>(properties.multiProcessorCount), all, free};
    return out;
}

}  // namespace coppice
