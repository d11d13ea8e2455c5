#include <algorithm>
#include <atomic>
#include <system_error>
#include <thread>
#include <vector>

#include "coppice/base/parallel_internal.h"

namespace coppice::base_internal {

void run_on_own_threads(unsigned threads, std::size_t count, const std::function<void(std::size_t)>& run) {
    std::atomic<std::size_t> next = 0;
    const auto work = [&] {
        // Relaxed, so that this counter synchronises nothing else and hides no race from ThreadSanitizer.
        for (std::size_t i; (i = next.fetch_add(1, std::memory_order_relaxed)) < count;) run(i);
    };
    const std::size_t wanted = std::min<std::size_t>(threads, count);
    std::vector<std::jthread> helpers;
    helpers.reserve(wanted);
    try {
        while (helpers.size() + 1 < wanted) helpers.emplace_back(work);
    } catch (const std::system_error&) {
        // No more threads can be created; the existing ones do all the work.
    }
    work();
}

}  // namespace coppice::base_internal
