#pragma once

#include <algorithm>
#include <cstddef>
#include <functional>

#include "coppice/base/context.h"
#include "coppice/base/parallel.h"

namespace coppice {

/// The context of one part of a task: its progress from 0 to 1 is that of the whole from `begin` to `end`.
inline Context part_of(const Context& ctx, float begin, float end) {
    Context part = ctx;
    if (ctx.progress) {
        part.progress = [report = ctx.progress, begin, end](float f) { report(begin + (end - begin) * f); };
    }
    return part;
}

/// Looks for a stop every 65,536 turns of a long loop of short ones. Throws Cancelled.
inline void poll_stop(const Context& ctx, std::size_t turn) {
    if (turn % 65536 == 0) ctx.throw_if_cancelled();
}

/// One look up from a long loop, after `done` of `total` steps: throws Cancelled when a stop was asked for,
/// else reports how far the work is.
inline void check_in(const Context& ctx, std::size_t done, std::size_t total) {
    ctx.throw_if_cancelled();
    if (total > 0) ctx.report(static_cast<float>(done) / static_cast<float>(total));
}

/// As parallel_for_ranges, over the same ranges, and reports how far it is from time to time.
inline void parallel_with_progress(const Context& ctx, std::size_t count, std::size_t grain,
                                   const std::function<void(IndexRange)>& body) {
    constexpr std::size_t kLeast = 16;  // ranges between two reports: threads wait for each other at these
    constexpr std::size_t kReports = 100;
    if (!ctx.progress) return parallel_for_ranges(ctx, count, grain, body);
    const std::size_t ranges = (count + grain - 1) / grain;
    const std::size_t batch = std::max(kLeast, (ranges + kReports - 1) / kReports) * grain;
    for (std::size_t first = 0; first < count; first += batch) {
        const std::size_t size = std::min(batch, count - first);
        parallel_for_ranges(ctx, size, grain, [&](IndexRange r) { body({first + r.begin, first + r.end}); });
        check_in(ctx, first + size, count);
    }
}

}  // namespace coppice
