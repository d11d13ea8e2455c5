#include "coppice/cuda/device.h"

#include "coppice/cuda/exec/cuda_check.cuh"

namespace coppice {
namespace {

// Products and sums in single precision that a multiprocessor begins in one cycle.
int lanes_of(int compute) { return compute == 75 || compute == 80 ? 64 : 128; }

double attribute(cudaDeviceAttr which) {
    int value = 0;
    return cudaDeviceGetAttribute(&value, which, 0) == cudaSuccess ? value : 0;
}

}  // namespace

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
    DeviceInfo info{properties.name, 10 * properties.major + properties.minor,
                    static_cast<std::uint32_t>(properties.multiProcessorCount), all, free};
    constexpr double kHertz = 1e3, kBits = 8;  // clocks are told in kHz, buses in bits
    info.flops =
        2.0 * lanes_of(info.compute) * info.multiprocessors * attribute(cudaDevAttrClockRate) * kHertz;
    info.bandwidth = 2 * attribute(cudaDevAttrMemoryClockRate) * kHertz *
                     attribute(cudaDevAttrGlobalMemoryBusWidth) / kBits;
    out.device = info;
    return out;
}

}  // namespace coppice
