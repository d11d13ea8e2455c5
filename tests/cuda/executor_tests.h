#pragma once

#include <gtest/gtest.h>

#include <algorithm>
#include <cstdint>
#include <numeric>
#include <random>
#include <stop_token>
#include <vector>

#include "coppice/base/context.h"
#include "coppice/base/error.h"
#include "coppice/cuda/exec/atomics_internal.h"
#include "on_executor.h"

// Tests of the common behaviour of all executors.

namespace coppice::cuda {

template <class T>
std::vector<T> random_numbers(std::size_t count, T below) {
    std::mt19937_64 random(count + 1);
    std::vector<T> out(count);
    for (T& x : out) x = static_cast<T>(random() % below);
    return out;
}

template <class Exec>
class ExecutorOn : public OnExecutor<Exec> {
  protected:
    template <class T>
    static void expect_scanned(std::size_t count) {
        SCOPED_TRACE(count);
        Exec exec;
        const std::vector<T> numbers = random_numbers<T>(count, 1000);
        const auto in = exec.template array<T>(count), out = exec.template array<T>(count);
        exec.write(std::span<const T>(numbers), in);
        exec.exclusive_scan(std::span<const T>(in), out);
        exec.exclusive_scan(std::span<const T>(in), in);
        Buffer<T> expected(count);
        std::exclusive_scan(numbers.begin(), numbers.end(), expected.begin(), T{});
        EXPECT_EQ(downloaded(exec, out), expected);
        EXPECT_EQ(downloaded(exec, in), expected) << "in place";
    }
};
TYPED_TEST_SUITE_P(ExecutorOn);

struct Square {
    std::span<const std::uint32_t> in;
    std::span<std::uint32_t> out;
    COPPICE_HOST_DEVICE void operator()(std::uint32_t i) const { out[i] = in[i] * in[i]; }
};

TYPED_TEST_P(ExecutorOn, RunsKernelsOverArrays) {
    TypeParam exec(Context{.threads = 2});
    for (const std::uint32_t count : {0u, 1u, 127u, 128u, 129u, 5000u}) {
        std::vector<std::uint32_t> numbers(count);
        std::iota(numbers.begin(), numbers.end(), 0u);
        const auto in = exec.upload(std::span<const std::uint32_t>(numbers));
        std::fill(numbers.begin(), numbers.end(), 7u);  // uploaded data need not outlive the call
        const auto out = exec.template array<std::uint32_t>(count);
        exec.each("square", count, Square{in, out});
        const Buffer<std::uint32_t> squares = downloaded(exec, out);
        for (std::uint32_t i = 0; i < count; ++i) ASSERT_EQ(squares[i], i * i);
    }
}

// Every group writes the indices of its odd numbers to the start of its row, and their count to the end.
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

TYPED_TEST_P(ExecutorOn, GroupsSelectInOrder) {
    for (const std::uint32_t row : {1u, 2u, 33u, 128u, 129u, 130u, 257u, 1000u}) {
        SCOPED_TRACE(row);
        constexpr std::uint32_t kGroups = 50;
        TypeParam exec;
        const auto numbers = random_numbers<std::uint32_t>(std::size_t{kGroups} * row, 1000);
        const auto in = exec.upload(std::span<const std::uint32_t>(numbers));
        const auto out = exec.template array<std::uint32_t>(numbers.size());
        exec.clear(out);  // not all of it is written
        exec.groups("odd", kGroups, Odd{in, out, row});
        const Buffer<std::uint32_t> found = downloaded(exec, out);
        for (std::uint32_t g = 0; g < kGroups; ++g) {
            std::uint32_t count = 0;
            for (std::uint32_t k = 0; k + 1 < row; ++k) {
                if (numbers[g * row + k] % 2 == 0) continue;
                ASSERT_EQ(found[g * row + count++], k);
            }
            ASSERT_EQ(found[g * row + row - 1], count);
        }
    }
}

// Prefix sums by doubling: each step reads data that other threads wrote in the previous one.
struct Doubling {
    std::span<std::uint32_t> even, odd;
    template <class Group>
    COPPICE_HOST_DEVICE void operator()(std::uint32_t, const Group& group) const {
        const auto size = static_cast<std::uint32_t>(even.size());
        std::span<std::uint32_t> from = even, to = odd;
        for (std::uint32_t reach = 1; reach < size; reach *= 2) {
            group.each(size, [&](std::uint32_t i) { to[i] = from[i] + (i >= reach ? from[i - reach] : 0); });
            const std::span<std::uint32_t> last = from;
            from = to;
            to = last;
        }
    }
};

TYPED_TEST_P(ExecutorOn, GroupsWaitAfterEveryStep) {
    TypeParam exec;
    const std::vector<std::uint32_t> ones(1024, 1);  // ten steps: the result is in the initial array
    const auto even = exec.template array<std::uint32_t>(ones.size());
    const auto odd = exec.template array<std::uint32_t>(ones.size());
    exec.write(std::span<const std::uint32_t>(ones), even);
    exec.groups("doubling", 1, Doubling{even, odd});
    const Buffer<std::uint32_t> sums = downloaded(exec, even);
    for (std::uint32_t i = 0; i < sums.size(); ++i) ASSERT_EQ(sums[i], i + 1);
}

struct Count {
    std::span<const std::uint32_t> in;
    std::span<std::uint32_t> sums;        // by remainder
    std::span<unsigned long long> total;  // one element
    std::span<std::uint32_t> largest;     // one element
    std::span<std::uint64_t> bits;        // numbers that occur
    COPPICE_HOST_DEVICE void operator()(std::uint32_t i) const {
        add_to(sums[in[i] % 3], 1u);
        add_to(total[0], static_cast<unsigned long long>(in[i]));
        raise_to(largest[0], in[i]);
        set_bits(bits[in[i] / 64], std::uint64_t{1} << (in[i] % 64));
    }
};

TYPED_TEST_P(ExecutorOn, AddsIntegersAtomically) {
    TypeParam exec(Context{.threads = 2});
    const auto numbers = random_numbers<std::uint32_t>(20'000, 640);
    const auto sums = exec.template array<std::uint32_t>(3), largest = exec.template array<std::uint32_t>(1);
    const auto total = exec.template array<unsigned long long>(1);
    const auto bits = exec.template array<std::uint64_t>(10);
    exec.clear(sums);
    exec.clear(largest);
    exec.clear(total);
    exec.clear(bits);
    exec.each("count", numbers.size(),
              Count{exec.upload(std::span<const std::uint32_t>(numbers)), sums, total, largest, bits});
    Buffer<std::uint32_t> by_remainder(3);
    std::vector<std::uint64_t> occur(10);
    std::fill(by_remainder.begin(), by_remainder.end(), 0u);
    for (const std::uint32_t x : numbers) {
        ++by_remainder[x % 3];
        occur[x / 64] |= std::uint64_t{1} << (x % 64);
    }
    EXPECT_EQ(downloaded(exec, sums), by_remainder);
    EXPECT_EQ(downloaded(exec, total)[0], std::accumulate(numbers.begin(), numbers.end(), 0ull));
    EXPECT_EQ(downloaded(exec, largest)[0], std::ranges::max(numbers));
    EXPECT_TRUE(std::ranges::equal(downloaded(exec, bits), occur));
}

TYPED_TEST_P(ExecutorOn, ComputesExclusiveScans) {
    for (const std::size_t count : {0u, 1u, 1000u, 300'000u}) {
        this->template expect_scanned<std::uint32_t>(count);
        this->template expect_scanned<std::uint64_t>(count);
    }
}

TYPED_TEST_P(ExecutorOn, SortsStablyByTheGivenBits) {
    for (const std::size_t count : {0u, 1u, 4u, 100'000u}) {
        for (const int bits : {8, 42, 64}) {
            SCOPED_TRACE(testing::Message() << count << " by " << bits);
            std::vector<std::uint64_t> numbers = random_numbers<std::uint64_t>(count, 300);
            for (std::uint64_t& x : numbers) x |= (x % 3 == 0 ? std::uint64_t{1} : 0) << 50;
            TypeParam exec;
            const auto keys = exec.template array<std::uint64_t>(count);
            const auto values = exec.template array<std::uint32_t>(count);
            std::vector<std::uint32_t> order(count);
            std::iota(order.begin(), order.end(), 0u);
            exec.write(std::span<const std::uint64_t>(numbers), keys);
            exec.write(std::span<const std::uint32_t>(order), values);
            exec.sort_pairs(keys, values, bits);
            const std::uint64_t mask = ~std::uint64_t{0} >> (64 - bits);
            std::ranges::stable_sort(order, {}, [&](std::uint32_t i) { return numbers[i] & mask; });
            EXPECT_TRUE(std::ranges::equal(downloaded(exec, values), order));
            const auto sorted = downloaded(exec, keys);
            for (std::size_t i = 0; i < count; ++i) ASSERT_EQ(sorted[i], numbers[order[i]]);
        }
    }
}

TYPED_TEST_P(ExecutorOn, ResetToAMarkPreservesEarlierArrays) {
    TypeParam exec;
    const auto numbers = random_numbers<std::uint32_t>(1'000'000, 1000);
    const std::span<const std::uint32_t> all(numbers);
    for (int round = 0; round < 3; ++round) {
        const auto kept = exec.upload(all.first(1000));
        const auto mark = exec.mark();
        for (const std::size_t count : {10u, 300'000u, 1'000'000u}) {
            const auto more = exec.upload(all.first(count));
            EXPECT_TRUE(std::ranges::equal(downloaded(exec, more), all.first(count)));
        }
        exec.rewind(mark);
        const auto again = exec.template array<std::uint32_t>(500'000);
        exec.clear(again);
        EXPECT_TRUE(std::ranges::equal(downloaded(exec, kept), all.first(1000)));
        EXPECT_EQ(std::ranges::count(downloaded(exec, again), 0u), 500'000);
        exec.reset();
    }
}

TYPED_TEST_P(ExecutorOn, StopsBeforeTheNextKernel) {
    std::stop_source source;
    TypeParam exec(Context{.threads = 1, .stop = source.get_token()});
    const auto out = exec.template array<std::uint32_t>(100);
    exec.clear(out);
    exec.each("square", out.size(), Square{out, out});
    source.request_stop();
    EXPECT_THROW(exec.each("square", out.size(), Square{out, out}), Cancelled);
}

// The first call, the recording call, and repeated calls; then again after clear().
TYPED_TEST_P(ExecutorOn, RecordingRepeatsLaunchesOnCurrentData) {
    constexpr std::uint32_t kCount = 5000;
    TypeParam exec;
    typename TypeParam::Recording recording;
    const auto in = exec.template array<std::uint32_t>(kCount);
    const auto before = exec.mark();
    std::span<const std::uint32_t> sums;
    for (std::uint32_t round = 0; round < 6; ++round) {
        SCOPED_TRACE(round);
        const std::vector<std::uint32_t> numbers(kCount, round);
        exec.rewind(before);
        exec.write(std::span<const std::uint32_t>(numbers), in);
        exec.replay(recording, [&] {
            const auto squares = exec.template array<std::uint32_t>(kCount);
            exec.each("square", kCount, Square{in, squares});
            exec.exclusive_scan(std::span<const std::uint32_t>(squares), squares);
            sums = squares;
        });
        EXPECT_EQ(downloaded(exec, sums).back(), (kCount - 1) * round * round);
        if (round == 3) recording.clear();
    }
}

REGISTER_TYPED_TEST_SUITE_P(ExecutorOn, RunsKernelsOverArrays, GroupsSelectInOrder, GroupsWaitAfterEveryStep,
                            AddsIntegersAtomically, ComputesExclusiveScans, SortsStablyByTheGivenBits,
                            ResetToAMarkPreservesEarlierArrays, StopsBeforeTheNextKernel,
                            RecordingRepeatsLaunchesOnCurrentData);

}  // namespace coppice::cuda
