#include "../executor_tests.h"
#include "coppice/cuda/exec/cuda_executor.cuh"

namespace coppice::cuda {
namespace {

INSTANTIATE_TYPED_TEST_SUITE_P(Card, ExecutorOn, CudaExecutor);

class CardExecutor : public OnExecutor<CudaExecutor> {};

TEST_F(CardExecutor, ThrowsIfMemoryIsTooSmallAndRemainsUsable) {
    const std::uint64_t memory = require_device().memory;
    CudaExecutor exec;
    EXPECT_THROW(exec.reserve(memory + 1), DeviceError);
    EXPECT_THROW(exec.array<std::byte>(2 * memory), DeviceError);
    const std::vector<std::uint32_t> numbers(1000, 3);
    const auto in = exec.upload(std::span<const std::uint32_t>(numbers));
    const auto out = exec.array<std::uint32_t>(numbers.size());
    exec.each("square", out.size(), Square{in, out});
    EXPECT_EQ(downloaded(exec, out)[999], 9u);
    exec.reset();
    exec.reserve(std::size_t{1} << 24);
    EXPECT_EQ(exec.array<std::byte>(std::size_t{1} << 24).size(), std::size_t{1} << 24);
    EXPECT_EQ(exec.bytes_used(), std::size_t{1} << 24);
}

TEST_F(CardExecutor, ThrowsForMoreItemsThanALaunchAccepts) {
    CudaExecutor exec;
    const std::span<std::uint32_t> none;
    EXPECT_THROW(exec.each("square", std::size_t{1} << 32, Square{none, none}), DeviceError);
    EXPECT_THROW(exec.groups("odd", std::size_t{1} << 31, Odd{none, none, 1}), DeviceError);
    EXPECT_NO_THROW(exec.wait());
}

TEST_F(CardExecutor, RecordsTheTimeOfEveryLaunch) {
    CudaExecutor exec;
    const auto out = exec.array<std::uint32_t>(1 << 20);
    exec.clear(out);
    exec.each("before", out.size(), Square{out, out});
    exec.measure();
    exec.each("square", out.size(), Square{out, out});
    exec.exclusive_scan(std::span<const std::uint32_t>(out), out);
    const std::vector<KernelTime> times = exec.take_times();
    ASSERT_EQ(times.size(), 2u);
    EXPECT_STREQ(times[0].name, "square");
    EXPECT_STREQ(times[1].name, "scan");
    EXPECT_GT(times[0].seconds, 0);
    EXPECT_TRUE(exec.take_times().empty());
}

TEST_F(CardExecutor, RunsConcurrentlyWithAnother) {
    CudaExecutor one, other;
    const auto numbers = random_numbers<std::uint32_t>(1 << 20, 60'000);
    const auto in = one.upload(std::span<const std::uint32_t>(numbers));
    const auto in_other = other.upload(std::span<const std::uint32_t>(numbers));
    const auto out = one.array<std::uint32_t>(numbers.size());
    const auto out_other = other.array<std::uint32_t>(numbers.size());
    for (int round = 0; round < 20; ++round) {
        one.each("square", numbers.size(), Square{in, out});
        other.exclusive_scan(in_other, out_other);
    }
    const auto squares = downloaded(one, out), sums = downloaded(other, out_other);
    std::uint32_t sum = 0;
    for (std::size_t i = 0; i < numbers.size(); sum += numbers[i++]) {
        ASSERT_EQ(squares[i], numbers[i] * numbers[i]);
        ASSERT_EQ(sums[i], sum);
    }
}

}  // namespace
}  // namespace coppice::cuda
