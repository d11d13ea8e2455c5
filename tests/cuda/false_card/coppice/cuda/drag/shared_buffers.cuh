#pragma once

#include "coppice/cuda/drag/device_drag.h"
#include "coppice/cuda/drag/drag_stages.h"
#include "coppice/cuda/exec/cuda_executor.cuh"

namespace coppice::cuda {

/// In the place of the header of the same name: the false card does not draw, so that frames go by way of the
/// host.
class SharedBuffers {
  public:
    static int drawing_device() { return -1; }
    explicit SharedBuffers(const DrawnBuffers&) { throw DeviceError("the false card does not draw"); }

    template <class Write>
    void lend(CudaExecutor&, const Write&) {}
};

}  // namespace coppice::cuda
