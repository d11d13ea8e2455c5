#pragma once

#include "coppice/cuda/exec/cuda_executor.cuh"
#include "drag/device_drag.h"
#include "drag/drag_stages.h"

namespace coppice::bench {

/// Replaces the header of the same name: the fake device does not draw, so that frames are copied through the
/// host.
class SharedBuffers {
  public:
    static int find_drawing_device() { return -1; }
    explicit SharedBuffers(const DrawnBuffers&) { throw DeviceError("the fake device does not draw"); }

    template <class Write>
    void lend(cuda::CudaExecutor&, const Write&) {}
};

}  // namespace coppice::bench
