// Takes the place of parallel.cpp where COPPICE_PLAIN_THREADS is on: ThreadSanitizer sees std::thread start
// and join, but not the hand-overs inside the distribution's oneTBB, and would take each of them for a race.

#include <atomic>
#include <thread>

#include "coppice/base/parallel.h"

namespace coppice {

void parallel_for_ranges(const Context& ctx, std::size_t count, std::size_t grain,
                         const std::function<void(IndexRange)>& body) {
    COPPICE_ASSERT(grain > 0);
    const std::size_t ranges = (count + grain - 1) / grain;
    const unsigned wanted =
        ctx.threads != 0 ? ctx.threads : std::max(2u, std::thread::hardware_concurrency());
    std::atomic<std::size_t> next = 0;
    const auto work = [&] {
        // Relaxed, so that taking turns here orders nothing else and hides no race.
        for (std::size_t i; (i = next.fetch_add(1, std::memory_order_relaxed)) < ranges;) {
            body({i * grain, std::min(count, (i + 1) * grain)});
        }
    };
    std::vector<std::jthread> helpers;
    for (std::size_t t = 1; t < std::min<std::size_t>(wanted, ranges); ++t) helpers.emplace_back(work);
    work();
}

}  // namespace coppice
