#include "coppice/cuda/device.h"

#include <map>
#include <mutex>
#include <string>

#include "coppice/cuda/exec/cuda_check.cuh"

namespace coppice {
namespace {

constexpr int kMinCompute = 75;

// Number of single-precision products and sums that a multiprocessor starts in one cycle.
int count_lanes(int compute) { return compute == 75 || compute == 80 ? 64 : 128; }

// Returns the reason why there is no device, as the end of a sentence.
std::string describe_error(cudaError_t error) {
    switch (error) {
        case cudaErrorNoDevice:
            return "this machine has none, or CUDA_VISIBLE_DEVICES hides it";
        case cudaErrorInsufficientDriver:
            return "there is no NVIDIA driver, or it is too old";
        default:
            return cudaGetErrorString(error);
    }
}

// Returns 0 if the driver does not report the attribute.
double attribute(cudaDeviceAttr which, int device) {
    int value = 0;
    if (cudaDeviceGetAttribute(&value, which, device) == cudaSuccess) return value;
    cudaGetLastError();  // otherwise the next launch would report it
    return 0;
}

// Queries everything except the free memory. Includes the start of the driver and some milliseconds.
DeviceSearch first_search(int number) {
    DeviceSearch out;
    const auto failed = [&](cudaError_t error) {
        cudaGetLastError();
        if (error != cudaSuccess) out.missing = describe_error(error);
        return error != cudaSuccess;
    };
    int count = 0;
    if (failed(cudaGetDeviceCount(&count))) return out;
    if (number >= count) {
        out.missing = count == 0 ? "CUDA finds no device" : "CUDA finds no device with this number";
        return out;
    }
    cudaDeviceProp properties{};
    if (failed(cudaGetDeviceProperties(&properties, number))) return out;
    DeviceInfo info{properties.name, 10 * properties.major + properties.minor,
                    static_cast<std::uint32_t>(properties.multiProcessorCount), properties.totalGlobalMem};
    if (info.compute < kMinCompute) {
        out.missing = info.name + " has capability " + std::to_string(properties.major) + "." +
                      std::to_string(properties.minor) + ", but at least 7.5 is required";
        return out;
    }
    constexpr double kHertz = 1e3, kBits = 8;  // clocks are in kHz, bus widths in bits
    info.flops = 2.0 * count_lanes(info.compute) * info.multiprocessors *
                 attribute(cudaDevAttrClockRate, number) * kHertz;
    info.bandwidth = 2 * attribute(cudaDevAttrMemoryClockRate, number) * kHertz *
                     attribute(cudaDevAttrGlobalMemoryBusWidth, number) / kBits;
    out.device = info;
    return out;
}

// Returns the cached result of the first search.
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
        return {{}, describe_error(error)};
    }
    out.device->free = free;
    return out;
}

}  // namespace coppice
