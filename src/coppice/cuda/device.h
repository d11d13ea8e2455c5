#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <string>
#include <string_view>

#include "coppice/base/error.h"
#include "coppice/base/fields.h"

namespace coppice {

/// Selects where work that supports a GPU is executed. Topology does not depend on the device; positions
/// agree to 1e-4 of the local radius.
enum class Device {
    automatic,  ///< on the GPU if there is one and the work is large enough to benefit
    cpu,        ///< never on a GPU
    cuda  ///< on the GPU, or an error if there is no GPU; on the CPU, with a note, if the work is too small
};

template <>
struct EnumNames<Device> {
    static constexpr std::array<std::string_view, 3> names{"auto", "cpu", "cuda"};
};

/// A GPU that can run the kernels.
struct DeviceInfo {
    std::string name;                   ///< as reported by the driver
    int compute = 0;                    ///< capability: 90 for 9.0
    std::uint32_t multiprocessors = 0;  ///< number of multiprocessors
    std::uint64_t memory = 0;           ///< [bytes] total
    std::uint64_t free = 0;             ///< [bytes] free at the time of the search
    double flops = 0;      ///< [1/s] peak in single precision, counting products and sums separately
    double bandwidth = 0;  ///< [bytes/s] peak of its memory
};

/// Result of the search for a GPU: exactly one of the members is set.
struct DeviceSearch {
    std::optional<DeviceInfo> device;  ///< the GPU
    std::string missing;               ///< or the reason why there is no device, as the end of a sentence
};

/// Searches for the GPU with this CUDA number and selects it on this thread. The first call includes the
/// start of the driver, some tenths of a second; later calls only query the free memory. Never throws.
DeviceSearch find_device(int number = 0);

/// Returns whether this build contains the kernels: see COPPICE_CUDA in the build.
bool has_cuda();

/// The GPU failed or has too little memory; the CPU can still do the work.
class DeviceError : public Error {
  public:
    using Error::Error;
};

/// The work is too large for the GPU, usually for its memory; it can still be done in smaller batches.
class DeviceFull : public DeviceError {
  public:
    using DeviceError::DeviceError;
};

/// Returns the same GPU. Throws DeviceError with the reason and a remedy if there is no device.
DeviceInfo require_device(int number = 0);

/// Throws DeviceFull with both numbers if less memory is free on a GPU than required [bytes].
void require_room(std::uint64_t free, std::uint64_t needed);

}  // namespace coppice
