#include "coppice/base/parallel.h"

#ifndef COPPICE_PLAIN_THREADS
#include <oneapi/tbb/blocked_range.h>
#include <oneapi/tbb/info.h>
#include <oneapi/tbb/parallel_for.h>
#include <oneapi/tbb/task_arena.h>
#endif

#include <atomic>
#include <exception>
#include <new>
#include <stdexcept>
#include <thread>

#include "coppice/base/parallel_internal.h"

namespace coppice {
namespace {

using RunOne = std::function<void(std::size_t)>;

#ifdef COPPICE_PLAIN_THREADS

void run_all(unsigned threads, std::size_t count, const RunOne& run) {
    const unsigned machine = std::max(2u, std::thread::hardware_concurrency());
    base_internal::run_on_own_threads(threads != 0 ? threads : machine, count, run);
}

#else

/// oneTBB's threads belong to the process, and their number is not changed here: a loop that requests more,
/// as tests do, starts its own threads.
void run_all(unsigned threads, std::size_t count, const RunOne& run) {
    const auto loop = [&] {
        oneapi::tbb::parallel_for(oneapi::tbb::blocked_range<std::size_t>(0, count, 1),
                                  [&](const auto& block) {
                                      for (std::size_t i = block.begin(); i < block.end(); ++i) run(i);
                                  });
    };
    const auto machine = static_cast<unsigned>(oneapi::tbb::info::default_concurrency());
    if (threads > machine) return base_internal::run_on_own_threads(threads, count, run);
    try {
        threads == 0 ? loop() : oneapi::tbb::task_arena(static_cast<int>(threads)).execute(loop);
    } catch (const std::runtime_error&) {
        // `run` throws nothing: oneTBB could not start a thread, because there is no memory for its stack.
        throw std::bad_alloc();
    }
}

#endif

}  // namespace

void parallel_for_ranges(const Context& ctx, std::size_t count, std::size_t grain,
                         const std::function<void(IndexRange)>& body) {
    COPPICE_ASSERT(grain > 0);
    const std::size_t ranges = (count + grain - 1) / grain;
    const auto run = [&](std::size_t i) {
        ctx.throw_if_cancelled();
        body({i * grain, std::min(count, (i + 1) * grain)});
    };
    if (ranges <= 1 || ctx.threads == 1) {
        for (std::size_t i = 0; i < ranges; ++i) run(i);
        return;
    }
    // Stored here instead of by oneTBB, which allocates to rethrow an exception: the most common exception
    // reports that memory is exhausted.
    std::atomic<bool> failed = false;
    std::exception_ptr failure;
    run_all(ctx.threads, ranges, [&](std::size_t i) {
        if (failed.load(std::memory_order_relaxed)) return;
        try {
            run(i);
        } catch (...) {
            if (!failed.exchange(true)) failure = std::current_exception();
        }
    });
    if (failure) std::rethrow_exception(failure);
}

}  // namespace coppice
