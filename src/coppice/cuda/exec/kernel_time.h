#pragma once

namespace coppice::cuda {

/// How long one launch took on the card.
struct KernelTime {
    const char* name;    ///< of the kernel
    double seconds = 0;  ///< between its beginning and its end
};

}  // namespace coppice::cuda
