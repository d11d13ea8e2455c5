#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <string>
#include <string_view>

#include "coppice/base/error.h"
#include "coppice/base/fields.h"

namespace coppice {

/// Where what can run on a graphics card runs. Topology is the same, positions agree to 1e-4 of the local
/// radius.
enum class Device {
    automatic,  ///< on the card where there is one and the work is large enough to be worth it
    cpu,        ///< never on a card
    cuda  ///< on the card, or an error where there is none; on the CPU, with a note, where it is too small
};

template <>
struct EnumNames<Device> {
    static constexpr std::array<std::string_view, 3> names{"auto", "cpu", "cuda"};
};

/// A card that kernels can run on.
struct DeviceInfo {
    std::string name;                   ///< as its maker calls it
    int compute = 0;                    ///< capability: 90 for 9.0
    std::uint32_t multiprocessors = 0;  ///< that it has
    std::uint64_t memory = 0;           ///< [bytes] in all
    std::uint64_t free = 0;             ///< [bytes] not in use when it was looked for
    double flops = 0;                   ///< [1/s] in single precision at most, product and sum counted apart
    double bandwidth = 0;               ///< [bytes/s] of its memory at most
};

/// What looking for a card found: one of the two.
struct DeviceSearch {
    std::optional<DeviceInfo> device;  ///< the card
    std::string missing;               ///< or why there is none, as the end of a sentence
};

/// Looks for the card to which CUDA gives this number, and chooses it on this thread; the first call takes as
/// long as the driver takes to start, some tenths of a second, and later ones only look how much memory is
/// free. Never throws.
DeviceSearch find_device(int number = 0);

/// Whether this build has the kernels at all: see COPPICE_CUDA in the build.
bool has_cuda();

/// The card failed, or has too little memory: the CPU can still do the work.
class DeviceError : public Error {
  public:
    using Error::Error;
};

/// The work is too large for the card, mostly for its memory: it can still do it in parts.
class DeviceFull : public DeviceError {
  public:
    using DeviceError::DeviceError;
};

/// The same card. Throws DeviceError, which says why and what to do, where there is none.
DeviceInfo require_device(int number = 0);

/// Throws DeviceFull, which says both numbers, where a card has less memory free than would be needed
/// [bytes].
void require_room(std::uint64_t free, std::uint64_t needed);

}  // namespace coppice
