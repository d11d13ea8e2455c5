#pragma once

#include <functional>
#include <stop_token>

#include "coppice/base/error.h"

namespace coppice {

/// Execution settings, as opposed to options of the computation: the last argument of every stage, never
/// global.
struct Context {
    unsigned threads = 0;                 ///< 0 = all hardware threads; does not affect the result
    std::stop_token stop;                 ///< polled between steps, not inside kernels
    std::function<void(float)> progress;  ///< in [0, 1], never decreases, called on the calling thread

    /// Throws `Cancelled` if a stop was requested.
    void throw_if_cancelled() const {
        if (stop.stop_requested()) throw Cancelled();
    }
    /// Calls `progress`, if it is set.
    void report(float fraction) const {
        if (progress) progress(fraction);
    }
};

}  // namespace coppice
