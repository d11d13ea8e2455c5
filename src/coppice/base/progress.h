#pragma once

#include <algorithm>
#include <cstddef>
#include <functional>

#include "coppice/base/context.h"
#include "coppice/base/parallel.h"

namespace coppice {

/// Returns the context of a section of a task: its progress from 0 to 1 is that of the whole task from
/// `begin` to `end`.
inline Context narrow_progress(const Context& ctx, float begin, float end) {
    Context part = ctx;
    if (ctx.progress) {
        part.progress = [report = ctx.progress, begin, end](float f) { report(begin + (end - begin) * f); };
    }
    return part;
}

/// Polls for a stop in every 65,536th iteration of a long loop of short iterations. Throws Cancelled.
inline void poll_stop(const Context& ctx, std::size_t turn) {
    if (turn % 65536 == 0) ctx.throw_if_cancelled();
}

/// Called between the steps of a long loop, after `done` of `total` steps: throws Cancelled if a stop was
/// requested, else reports the progress.
inline void check_in(const Context& ctx, std::size_t done, std::size_t total) {
    ctx.throw_if_cancelled();
    if (total > 0) ctx.report(static_cast<float>(done) / static_cast<float>(total));
}

/// Runs as parallel_for_ranges over the same ranges, and reports progress at intervals.
inline void parallel_with_progress(const Context& ctx, std::size_t count, std::size_t grain,
                                   const std::function<void(IndexRange)>& body) {
    // minimum number of ranges between two reports, at which threads wait for each other
    constexpr std::size_t kMin = 16;
    constexpr std::size_t kReports = 100;
    if (!ctx.progress) return parallel_for_ranges(ctx, count, grain, body);
    const std::size_t ranges = (count + grain - 1) / grain;
    const std::size_t batch = std::max(kMin, (ranges + kReports - 1) / kReports) * grain;
    for (std::size_t first = 0; first < count; first += batch) {
        const std::size_t size = std::min(batch, count - first);
        parallel_for_ranges(ctx, size, grain, [&](IndexRange r) { body({first + r.begin, first + r.end}); });
        check_in(ctx, first + size, count);
    }
}

}  // namespace coppice
