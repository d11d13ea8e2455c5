#pragma once

#include <algorithm>
#include <cstddef>
#include <vector>

#include "coppice/cuda/exec/host_executor_internal.h"
#include "coppice/cuda/exec/kernel_time.h"

namespace coppice::cuda {

inline constexpr std::size_t kFalseMemory = std::size_t{2} << 30;  ///< [bytes] of the fake device

/// Replaces the header of the same name by a fake device, so that the code of .cu files runs without a GPU.
class CudaExecutor : public HostExecutor {
  public:
    explicit CudaExecutor(const Context& ctx = {}, std::size_t most = kFalseMemory)
        : HostExecutor(ctx, std::min(most, kFalseMemory)) {}

    static void choose(int /*device*/) {}
    void measure() { measures_ = true; }
    std::vector<KernelTime> take_times() {
        std::vector<KernelTime> out;
        out.swap(times_);
        return out;
    }
    template <class Kernel>
    void each(const char* name, std::size_t count, const Kernel& kernel) {
        HostExecutor::each(name, count, kernel);
        if (measures_ && count > 0) times_.push_back({name, 1e-6});
    }

  private:
    bool measures_ = false;
    std::vector<KernelTime> times_;
};

}  // namespace coppice::cuda
