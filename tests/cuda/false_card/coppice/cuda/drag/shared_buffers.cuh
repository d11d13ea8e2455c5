#pragma once

#include "coppice/cuda/drag/device_drag.h"
#include "coppice/cuda/drag/drag_stages_internal.h"
#include "coppice/cuda/exec/cuda_executor.cuh"

namespace coppice::cuda {

/// Replaces the header of the same name: the fake device does not draw, so that frames are copied through the
/// host.
class SharedBuffers {
  public:
    static int drawing_device() { return -1; }
    explicit SharedBuffers(const DrawnBuffers&) { throw DeviceError("the fake device does not draw"); }

    template <class Write>
    void lend(CudaExecutor&, const Write&) {}
};

}  // namespace coppice::cuda
