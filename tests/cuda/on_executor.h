#pragma once

#include <gtest/gtest.h>

#include <cstdint>
#include <span>

#include "coppice/base/column.h"
#include "coppice/cuda/device.h"

namespace coppice::cuda {

/// Fixture of tests that run on any executor; on that of a GPU if there is one.
template <class Exec>
class OnExecutor : public testing::Test {
  protected:
    /// Whether results are bit-identical to the CPU: a GPU fuses products and sums.
    static constexpr bool kSameBits = !Exec::kIsDevice;

    /// Returns the size of a test: full size on a GPU, and smaller on the fake device, which runs kernels on
    /// the CPU.
    static std::uint32_t size_for(std::uint32_t card, std::uint32_t false_card) {
        return require_device().multiprocessors > 1 ? card : false_card;
    }

    void SetUp() override {
        if (!Exec::kIsDevice) return;
        const DeviceSearch search = find_device();
        if (!search.device) GTEST_SKIP() << search.missing;
    }
};

/// Requires the executor of the GPU inside the library.
struct Card {
    static constexpr bool kIsDevice = true;
};
using OnCard = OnExecutor<Card>;

/// Returns a copy of an array of an executor.
template <class Exec, class T>
Buffer<T> downloaded(Exec& exec, std::span<const T> from) {
    Buffer<T> out(from.size());
    exec.download(from, std::span<T>(out));
    return out;
}
template <class Exec, class T>
Buffer<T> downloaded(Exec& exec, std::span<T> from) {
    return downloaded(exec, std::span<const T>(from));
}

}  // namespace coppice::cuda
