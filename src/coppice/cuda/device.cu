#include "coppice/cuda/device.h"

#include <map>
#include <mutex>
#include <string>

#include "coppice/cuda/exec/cuda_check.cuh"

namespace coppice {
namespace {

constexpr int kLeastCompute = 75;

// Products and sums in single precision that a multiprocessor begins in one cycle.
int lanes_of(int compute) { return compute == 75 || compute == 80 ? 64 : 128; }

// Why there is no device, as the end of a sentence.
std::string reason_of(cudaError_t error) {
    switch (error) {
        case cudaErrorNoDevice:
            return "this machine has none, or CUDA_VISIBLE_DEVICES hides it";
        case cudaErrorInsufficientDriver:
            return "there is no NVIDIA driver, or it is too old";
        default:
            return cudaGetErrorString(error);
    }
}

// 0 of what the driver does not tell.
double attribute(cudaDeviceAttr which, int device) {
    int value = 0;
    if (cudaDeviceGetAttribute(&value, which, device) == cudaSuccess) return value;
    cudaGetLastError();  // or the next launch is blamed
    return 0;
}

// All but how much memory is free. Takes the driver's time to start, and some milliseconds more.
DeviceSearch first_search(int number) {
    DeviceSearch out;
    const auto failed = [&](cudaError_t error) {
        cudaGetLastError();
        if (error != cudaSuccess) out.missing = reason_of(error);
        return error != cudaSuccess;
    };
    int count = 0;
    if (failed(cudaGetDeviceCount(&count))) return out;
    if (number >= count) {
        out.missing = count == 0 ? "CUDA finds no device" : "CUDA finds no device of this number";
        return out;
    }
    cudaDeviceProp properties{};
    if (failed(cudaGetDeviceProperties(&properties, number))) return out;
    DeviceInfo info{properties.name, 10 * properties.major + properties.minor,
                    static_cast<std::uint32_t>(properties.multiProcessorCount), properties.totalGlobalMem};
    if (info.compute < kLeastCompute) {
        out.missing = info.name + " has capability " + std::to_string(properties.major) + "." +
                      std::to_string(properties.minor) + ", and 7.5 is the least that will do";
        return out;
    }
    constexpr double kHertz = 1e3, kBits = 8;  // clocks are told in kHz, buses in bits
    info.flops = 2.0 * lanes_of(info.compute) * info.multiprocessors *
                 attribute(cudaDevAttrClockRate, number) * kHertz;
    info.bandwidth = 2 * attribute(cudaDevAttrMemoryClockRate, number) * kHertz *
                     attribute(cudaDevAttrGlobalMemoryBusWidth, number) / kBits;
    out.device = info;
    return out;
}

// The same, looked for once.
DeviceSearch known(int number) {
    static std::mutex mutex;
    static std::map<int, DeviceSearch> found;
    const std::scoped_lock lock(mutex);
    const auto at = found.find(number);
    return at != found.end() ? at->second : found.emplace(number, first_search(number)).first->second;
}

}  // namespace

bool has_cuda() { return true; }

DeviceSearch find_device(int number) {
    DeviceSearch out = known(number);
    if (!out.device) return out;
    std::size_t free = 0, all = 0;
    cudaError_t error = cudaSetDevice(number);
    if (error == cudaSuccess) error = cudaMemGetInfo(&free, &all);
    if (error != cudaSuccess) {
        cudaGetLastError();
        return {{}, reason_of(error)};
    }
    out.device->free = free;
    return out;
}

}  // namespace coppice
