#pragma once

#include <gtest/gtest.h>

#include <cstdint>
#include <span>

#include "coppice/base/column.h"
#include "coppice/cuda/device.h"

namespace coppice::cuda {

/// What runs on any executor; on that of a card, where there is one.
template <class Exec>
class OnExecutor : public testing::Test {
  protected:
    /// Whether results have the bits of the CPU: a card fuses products and sums.
    static constexpr bool kSameBits = !Exec::kIsDevice;

    /// How large a test is: as large as it should be on a card, and less on the false one, whose kernels run
    /// on the CPU.
    static std::uint32_t size_for(std::uint32_t card, std::uint32_t false_card) {
        return require_device().multiprocessors > 1 ? card : false_card;
    }

    void SetUp() override {
        if (!Exec::kIsDevice) return;
        const DeviceSearch search = find_device();
        if (!search.device) GTEST_SKIP() << search.missing;
    }
};

/// What is made by a card's own executor, inside the library.
struct Card {
    static constexpr bool kIsDevice = true;
};
using OnCard = OnExecutor<Card>;

/// A copy of what lies on an executor.
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
