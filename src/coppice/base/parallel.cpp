#include "coppice/base/parallel.h"

#include <oneapi/tbb/blocked_range.h>
#include <oneapi/tbb/global_control.h>
#include <oneapi/tbb/parallel_for.h>
#include <oneapi/tbb/task_arena.h>

namespace coppice {

void parallel_for_ranges(const Context& ctx, std::size_t count, std::size_t grain,
                         const std::function<void(IndexRange)>& body) {
    COPPICE_ASSERT(grain > 0);
    const std::size_t ranges = (count + grain - 1) / grain;
    const auto run = [&](std::size_t i) { body({i * grain, std::min(count, (i + 1) * grain)}); };
    if (ranges <= 1 || ctx.threads == 1) {
        for (std::size_t i = 0; i < ranges; ++i) run(i);
        return;
    }
    const auto loop = [&] {
        oneapi::tbb::parallel_for(oneapi::tbb::blocked_range<std::size_t>(0, ranges, 1),
                                  [&](const auto& block) {
                                      for (std::size_t i = block.begin(); i < block.end(); ++i) run(i);
                                  });
    };
    if (ctx.threads == 0) {
        loop();
    } else {
        // More threads than the machine has are allowed too: tests ask for them.
        const oneapi::tbb::global_control allow(oneapi::tbb::global_control::max_allowed_parallelism,
                                                ctx.threads);
        oneapi::tbb::task_arena(static_cast<int>(ctx.threads)).execute(loop);
    }
}

}  // namespace coppice
