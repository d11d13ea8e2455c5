#pragma once

namespace coppice::cuda {

/// Duration of one launch on the GPU.
struct KernelTime {
    const char* name;    ///< of the kernel
    double seconds = 0;  ///< between its start and its end
};

}  // namespace coppice::cuda
