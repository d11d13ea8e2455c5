#include <gtest/gtest.h>

#include <cstdint>
#include <vector>

#include "coppice/cuda/exec/host_executor.h"

namespace coppice::cuda {
namespace {

struct Square {
    std::span<const std::uint32_t> in;
    std::span<std::uint32_t> out;
    COPPICE_HOST_DEVICE void operator()(std::uint32_t i) const { out[i] = in[i] * in[i]; }
};

// Every group writes where its odd numbers stand to the front of its row, and their count to the end.
struct Odd {
    std::span<const std::uint32_t> in;
    std::span<std::uint32_t> out;
    std::uint32_t row;
    template <class Group>
    COPPICE_HOST_DEVICE void operator()(std::uint32_t i, const Group& group) const {
        const std::uint32_t* const from = in.data() + i * row;
        std::uint32_t* const to = out.data() + i * row;
        const std::uint32_t count = group.select(
            row - 1, [&](std::uint32_t k) { return from[k] % 2 == 1; }, to);
        group.each(1, [&](std::uint32_t) { to[row - 1] = count; });
    }
};

TEST(HostExecutor, RunsKernelsOverArraysAndGroups) {
    HostExecutor executor(Context{.threads = 2});
    std::vector<std::uint32_t> numbers(5000);
    for (std::uint32_t i = 0; i < numbers.size(); ++i) numbers[i] = i;
    const auto in = executor.upload(std::span<const std::uint32_t>(numbers));
    const auto out = executor.array<std::uint32_t>(in.size());
    executor.each("square", in.size(), Square{in, out});
    std::vector<std::uint32_t> squares(in.size());
    executor.download(std::span<const std::uint32_t>(out), std::span(squares));
    for (std::uint32_t i = 0; i < squares.size(); ++i) ASSERT_EQ(squares[i], i * i);

    executor.groups("odd", 500, Odd{in, out, 10});
    executor.download(std::span<const std::uint32_t>(out), std::span(squares));
    EXPECT_EQ(squares[10], 1u);
    EXPECT_EQ(squares[13], 7u);
    EXPECT_EQ(squares[19], 4u);
}

TEST(HostExecutor, ScansAndSortsStably) {
    HostExecutor executor;
    std::vector<std::uint32_t> counts{3, 0, 2, 5};
    executor.exclusive_scan(std::span<const std::uint32_t>(counts), std::span(counts));
    EXPECT_EQ(counts, (std::vector<std::uint32_t>{0, 3, 3, 5}));

    std::vector<std::uint64_t> keys{7, 1, 7, 0};
    std::vector<std::uint32_t> values{0, 1, 2, 3};
    executor.sort_pairs(std::span(keys), std::span(values));
    EXPECT_EQ(values, (std::vector<std::uint32_t>{3, 1, 0, 2}));
    EXPECT_EQ(keys, (std::vector<std::uint64_t>{0, 1, 7, 7}));
}

}  // namespace
}  // namespace coppice::cuda
