#include "coppice/cuda/device.h"

#include <string>

namespace coppice {

DeviceInfo require_device(int number) {
    const DeviceSearch search = find_device(number);
    if (!search.device)
        throw DeviceError("no CUDA device was found: " + search.missing + "; use the device auto or cpu");
    return *search.device;
}

void require_room(std::uint64_t free, std::uint64_t needed) {
    if (needed <= free) return;
    throw DeviceFull("the CUDA device has " + std::to_string(free >> 20) + " MiB of memory free, and " +
                     std::to_string(needed >> 20) + " would be needed");
}

}  // namespace coppice
