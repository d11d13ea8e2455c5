#include "coppice/base/parallel.h"

#include <gtest/gtest.h>

#include <atomic>
#include <chrono>
#include <cstdint>
#include <set>
#include <thread>
#include <utility>

#include "coppice/base/random.h"

namespace coppice {
namespace {

constexpr unsigned kThreads[]{1, 2, 7, 0};

using Ranges = std::set<std::pair<std::size_t, std::size_t>>;

// Collects the ranges of the calls of the body, each in a separate element.
Ranges compute_ranges(unsigned threads, std::size_t count, std::size_t grain) {
    std::vector<IndexRange> seen(count / grain + 2);
    std::atomic<std::size_t> calls = 0;
    parallel_for_ranges({.threads = threads}, count, grain, [&](IndexRange range) { seen[calls++] = range; });
    Ranges ranges;
    for (std::size_t i = 0; i < calls; ++i) ranges.emplace(seen[i].begin, seen[i].end);
    EXPECT_EQ(ranges.size(), calls);
    return ranges;
}

TEST(ParallelForRanges, CutsAtMultiplesOfTheGrainForAnyNumberOfThreads) {
    for (const unsigned threads : kThreads) {
        SCOPED_TRACE(threads);
        EXPECT_EQ(compute_ranges(threads, 0, 4), Ranges{});
        EXPECT_EQ(compute_ranges(threads, 3, 4), (Ranges{{0, 3}}));
        EXPECT_EQ(compute_ranges(threads, 4, 4), (Ranges{{0, 4}}));
        EXPECT_EQ(compute_ranges(threads, 9, 4), (Ranges{{0, 4}, {4, 8}, {8, 9}}));
        EXPECT_EQ(compute_ranges(threads, 3, 1), (Ranges{{0, 1}, {1, 2}, {2, 3}}));
    }
}

TEST(ParallelForRanges, RunsInOrderOnTheCallersThreadForOneThread) {
    std::vector<std::size_t> begins;
    const std::thread::id caller = std::this_thread::get_id();
    bool here = true;
    parallel_for_ranges({.threads = 1}, 10, 3, [&](IndexRange range) {
        begins.push_back(range.begin);
        here = here && std::this_thread::get_id() == caller;
    });
    EXPECT_EQ(begins, (std::vector<std::size_t>{0, 3, 6, 9}));
    EXPECT_TRUE(here);
}

TEST(ParallelForRanges, RunsTwoThreadsConcurrently) {
    // Each of the two ranges waits for the other to begin; on one thread the loop times out.
    std::atomic<int> begun = 0;
    std::atomic<bool> met = true;
    parallel_for_ranges({.threads = 2}, 2, 1, [&](IndexRange) {
        ++begun;
        const auto patience = std::chrono::steady_clock::now() + std::chrono::seconds(20);
        while (begun < 2 && std::chrono::steady_clock::now() < patience) std::this_thread::yield();
        if (begun < 2) met = false;
    });
    EXPECT_TRUE(met);
}

TEST(ParallelForRanges, NeverExceedsTheNumberOfThreads) {
    for (const unsigned threads : {1u, 2u, 3u}) {
        std::atomic<unsigned> inside = 0, most = 0;
        parallel_for_ranges({.threads = threads}, 200, 1, [&](IndexRange) {
            const unsigned now = ++inside;
            for (unsigned before = most; before < now && !most.compare_exchange_weak(before, now);) {
            }
            std::this_thread::sleep_for(std::chrono::microseconds(50));
            --inside;
        });
        EXPECT_LE(most, threads);
    }
}

TEST(ParallelForRanges, AcceptsNestedLoops) {
    for (const unsigned threads : kThreads) {
        std::vector<std::size_t> cells(20 * 30, 0);
        parallel_for({.threads = threads}, 20, 1, [&](std::size_t row) {
            parallel_for({.threads = threads}, 30, 7,
                         [&](std::size_t column) { cells[30 * row + column] += 30 * row + column; });
        });
        for (std::size_t i = 0; i < cells.size(); ++i) EXPECT_EQ(cells[i], i) << threads;
    }
}

TEST(ParallelFor, VisitsEveryIndexOnce) {
    for (const unsigned threads : kThreads) {
        for (const std::size_t grain : {std::size_t{1}, std::size_t{64}, std::size_t{100'000}}) {
            std::vector<std::uint8_t> visits(10'001, 0);
            parallel_for({.threads = threads}, visits.size(), grain, [&](std::size_t i) { ++visits[i]; });
            EXPECT_EQ(visits, std::vector<std::uint8_t>(10'001, 1)) << threads << " threads, grain " << grain;
        }
    }
}

// Terms with a sum that depends on the order of addition.
float term(std::size_t i) { return static_cast<float>(CounterRandom(1, 1).uniform(i, -1, 1)); }

float compute_sum(IndexRange range) {
    float sum = 0;
    for (std::size_t i = range.begin; i < range.end; ++i) sum += term(i);
    return sum;
}

TEST(ParallelForUneven, AssignsAllThreadsToLargeItemsAndOneToSmallItems) {
    std::vector<unsigned> threads(9, 0);
    const auto is_large = [](std::size_t i) { return i % 4 == 0; };
    parallel_for_uneven({.threads = 3}, threads.size(), 2, is_large,
                        [&](std::size_t i, const Context& ctx) { threads[i] += ctx.threads; });
    EXPECT_EQ(threads, (std::vector<unsigned>{3, 1, 1, 1, 3, 1, 1, 1, 3}));
    std::vector<unsigned> alone(1, 0);
    parallel_for_uneven(
        {.threads = 3}, alone.size(), 2, [](std::size_t) { return false; },
        [&](std::size_t i, const Context& ctx) { alone[i] += ctx.threads; });
    EXPECT_EQ(alone, (std::vector<unsigned>{3}));
}

TEST(ParallelReduce, AddsTheRangesInIndexOrderForAnyNumberOfThreads) {
    constexpr std::size_t kCount = 10'000, kGrain = 64;
    float in_order = 0.5f, backwards = 0.5f;
    for (std::size_t i = 0; i < kCount; i += kGrain)
        in_order += compute_sum({i, std::min(kCount, i + kGrain)});
    for (std::size_t i = kCount / kGrain + 1; i-- > 0;)
        backwards += compute_sum({i * kGrain, std::min(kCount, (i + 1) * kGrain)});
    ASSERT_NE(in_order, backwards);  // otherwise this test could not fail
    for (const unsigned threads : kThreads) {
        for (int repeat = 0; repeat < 5; ++repeat) {
            EXPECT_EQ(parallel_reduce({.threads = threads}, kCount, kGrain, 0.5f, compute_sum, std::plus<>()),
                      in_order)
                << threads;
        }
    }
}

TEST(ParallelReduce, ReturnsTheInitialValueForNoIndices) {
    EXPECT_EQ(parallel_reduce(
                  {}, 0, 8, 42, [](IndexRange) { return 1; }, std::plus<>()),
              42);
}

TEST(ExclusiveScan, ReplacesEachValueByTheSumBeforeIt) {
    std::vector<int> counts{3, 0, 4, 1};
    EXPECT_EQ(exclusive_scan<int>(counts), 8);
    EXPECT_EQ(counts, (std::vector<int>{0, 3, 3, 7}));
    std::vector<int> none;
    EXPECT_EQ(exclusive_scan<int>(none), 0);
}

TEST(ParallelForRanges, StartsNoRangeAfterAStopRequest) {
    for (const unsigned threads : kThreads) {
        std::stop_source source;
        const Context ctx{.threads = threads, .stop = source.get_token()};
        std::atomic<int> begun_after = 0;
        EXPECT_THROW(parallel_for_ranges(ctx, 100'000, 1,
                                         [&](IndexRange range) {
                                             if (source.stop_requested()) ++begun_after;
                                             if (range.begin == 50) source.request_stop();
                                         }),
                     Cancelled);
        // Each other thread may have polled just before.
        const unsigned others = (threads == 0 ? std::thread::hardware_concurrency() : threads) - 1;
        EXPECT_LE(begun_after, static_cast<int>(others)) << threads;
        EXPECT_THROW(parallel_for({.threads = threads, .stop = source.get_token()}, 1, 1, [](std::size_t) {}),
                     Cancelled);
    }
}

TEST(ParallelForRanges, RejectsAGrainOfZero) {
    EXPECT_THROW(parallel_for_ranges({.threads = 1}, 1, 0, [](IndexRange) {}), PreconditionBroken);
}

}  // namespace
}  // namespace coppice
