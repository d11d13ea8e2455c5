#include "coppice/base/parallel.h"

#include <gtest/gtest.h>
#include <oneapi/tbb/global_control.h>

#include <atomic>
#include <chrono>
#include <latch>
#include <new>
#include <thread>

// Behaviour of loops inside another program.

namespace coppice {
namespace {

constexpr unsigned kThreads[] = {0, 1, 2, 7};

// Seven ranges wait for each other: with fewer threads than ranges the loop would never end.
TEST(ParallelGuest, RunsMoreThreadsThanCoresConcurrently) {
    constexpr unsigned kWanted = 7;
    std::latch all(kWanted);
    std::atomic<bool> together = true;
    parallel_for_ranges({.threads = kWanted}, kWanted, 1, [&](IndexRange) {
        all.count_down();
        const auto end = std::chrono::steady_clock::now() + std::chrono::seconds(10);
        while (!all.try_wait()) {
            if (std::chrono::steady_clock::now() > end) together = false;
            if (!together) return;
            std::this_thread::yield();
        }
    });
    EXPECT_TRUE(together);
}

TEST(ParallelGuest, PreservesTheThreadLimitOfTheHost) {
    using oneapi::tbb::global_control;
    const auto limit = [] { return global_control::active_value(global_control::max_allowed_parallelism); };
    for (const std::size_t host : {std::size_t{1}, std::size_t{2}, std::size_t{5}}) {
        const global_control of_host(global_control::max_allowed_parallelism, host);
        const std::size_t before = limit();
        for (const unsigned threads : kThreads) {
            std::atomic<int> changed = 0;
            parallel_for_ranges({.threads = threads}, 100, 1,
                                [&](IndexRange) { changed += limit() == before ? 0 : 1; });
            EXPECT_EQ(changed, 0) << host << " threads of the host, " << threads << " requested";
        }
    }
}

TEST(ParallelGuest, RethrowsExceptionsOfTheBody) {
    for (const unsigned threads : kThreads) {
        const auto loop = [&](std::size_t count) {
            parallel_for_ranges({.threads = threads}, count, 1, [](IndexRange r) {
                if (r.begin % 3 == 1) throw std::bad_alloc();
            });
        };
        EXPECT_THROW(loop(2), std::bad_alloc) << threads << " threads";
        EXPECT_THROW(loop(1000), std::bad_alloc) << threads << " threads";
    }
}

}  // namespace
}  // namespace coppice
