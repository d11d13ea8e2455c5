#include "coppice/cuda/device.h"

namespace coppice {

DeviceInfo require_device(int number) {
    const DeviceSearch search = find_device(number);
    if (!search.device) throw DeviceError("no CUDA device was found: " + search.missing);
    return *search.device;
}

}  // namespace coppice
