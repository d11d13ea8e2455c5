#pragma once

#include <functional>
#include <stop_token>

#include "coppice/base/error.h"

namespace coppice {

/// How to run, as opposed to what to compute: passed last to every stage, never global.
struct Context {
    unsigned threads = 0;                 ///< 0 = every hardware thread; changes time, never bits
    std::stop_token stop;                 ///< polled between steps, not inside kernels
    std::function<void(float)> progress;  ///< in [0, 1], never falls, called on the calling thread

    /// Throws `Cancelled` when a stop was asked for.
    void throw_if_cancelled() const {
        if (stop.stop_requested()) throw Cancelled();
    }
    /// Calls `progress`, if there is one.
    void report(float fraction) const {
        if (progress) progress(fraction);
    }
};

}  // namespace coppice
