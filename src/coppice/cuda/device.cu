#include "coppice/cuda/device.h"

#include "coppice/cuda/exec/cuda_check.cuh"

namespace coppice {
namespace {

// Products and sums in single precision that a multiprocessor begins in one cycle.
int lanes_of(int compute) { return compute == 75 || compute == 80 ? 64 : 128; }

double attribute(cudaDeviceAttr which, int device) {
    int value = 0;
    return cudaDeviceGetAttribute(&value, which, device) == cudaSuccess ? value : 0;
}

}  // namespace

bool has_cuda() { return true; }

DeviceSearch find_device(int number) {
    DeviceSearch out;
    const auto failed = [&](cudaError_t error) {
        cudaGetLastError();
        if (error != cudaSuccess) out.missing = cudaGetErrorString(error);
        return error != cudaSuccess;
    };
    int count = 0;
    if (failed(cudaGetDeviceCount(&count))) return out;
    if (number >= count) {
        out.missing = count == 0 ? "CUDA finds no device" : "CUDA finds no device of this number";
        return out;
    }
    cudaDeviceProp properties{};
    std::size_t free = 0, all = 0;
    if (failed(cudaSetDevice(number)) || failed(cudaGetDeviceProperties(&properties, number)) ||
        failed(cudaMemGetInfo(&free, &all))) {
        return out;
    }
    DeviceInfo info{properties.name, 10 * properties.major + properties.minor,
                    static_cast<std::uint32_t>(properties.multiProcessorCount), all, free};
    constexpr double kHertz = 1e3, kBits = 8;  // clocks are told in kHz, buses in bits
    info.flops = 2.0 * lanes_of(info.compute) * info.multiprocessors *
                 attribute(cudaDevAttrClockRate, number) * kHertz;
    info.bandwidth = 2 * attribute(cudaDevAttrMemoryClockRate, number) * kHertz *
                     attribute(cudaDevAttrGlobalMemoryBusWidth, number) / kBits;
    out.device = info;
    return out;
}

}  // namespace coppice
