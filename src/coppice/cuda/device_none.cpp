#include "coppice/cuda/device.h"

namespace coppice {

bool has_cuda() { return false; }

DeviceSearch find_device(int) { return {{}, "this program was built without CUDA"}; }

}  // namespace coppice
