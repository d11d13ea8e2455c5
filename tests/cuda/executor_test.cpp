#include "executor_tests.h"

#include <gtest/gtest-spi.h>

#include "coppice/cuda/exec/host_executor_internal.h"
#include "strict_executor.h"

namespace coppice::cuda {
namespace {

INSTANTIATE_TYPED_TEST_SUITE_P(Host, ExecutorOn, HostExecutor);
INSTANTIATE_TYPED_TEST_SUITE_P(Strict, ExecutorOn, StrictExecutor);

TEST(StrictExecutor, ReportsKernelsThatUseHostMemory) {
    std::vector<std::uint32_t> numbers(10, 3);
    StrictExecutor exec;
    [[maybe_unused]] const auto out = exec.array<std::uint32_t>(numbers.size());
#ifdef COPPICE_CLEARS_PADDING
    EXPECT_NONFATAL_FAILURE(exec.each("square", numbers.size(), Square{numbers, out}), "memory of the host");
#endif
    EXPECT_NONFATAL_FAILURE(exec.clear(std::span(numbers)), "is_there");
}

TEST(StrictExecutorDeathTest, DeviceArraysAreNotReadableByTheHost) {
    StrictExecutor exec;
    const auto out = exec.array<std::uint32_t>(10);
    exec.clear(out);
    EXPECT_DEATH(EXPECT_EQ(out[3], 0u), "");
}

}  // namespace
}  // namespace coppice::cuda
