#pragma once

#include <cstddef>

#include "coppice/base/context.h"
#include "coppice/base/parallel.h"

namespace coppice::extract_internal {

/// Looks at the stop token every 65,536 turns of a long loop. Throws Cancelled.
inline void poll_stop(const Context& ctx, std::size_t turn) {
    if (turn % 65536 == 0) ctx.throw_if_cancelled();
}

/// `parallel_for_ranges` that a stop cuts short: no range starts after it, and it throws Cancelled then.
template <class Body>
void stoppable_for_ranges(const Context& ctx, std::size_t count, std::size_t grain, const Body& body) {
    parallel_for_ranges(ctx, count, grain, [&](IndexRange range) {
        if (!ctx.stop.stop_requested()) body(range);
    });
    ctx.throw_if_cancelled();
}

/// Runs body(i) for every i in [0, count), as `stoppable_for_ranges`.
template <class Body>
void stoppable_for(const Context& ctx, std::size_t count, std::size_t grain, const Body& body) {
    stoppable_for_ranges(ctx, count, grain, [&](IndexRange range) {
        for (std::size_t i = range.begin; i < range.end; ++i) body(i);
    });
}

/// The context of a stage that takes the work from one fraction to another: it reports from 0 to 1 there.
inline Context stage_context(const Context& ctx, float from, float to) {
    Context stage = ctx;
    if (ctx.progress)
        stage.progress = [report = ctx.progress, from, to](float done) { report(from + (to - from) * done); };
    return stage;
}

}  // namespace coppice::extract_internal
