#pragma once

#include <cstddef>
#include <functional>

namespace coppice::base_internal {

/// run(i) for every i in [0, count), on threads that are started for this call alone and the caller's; on
/// fewer where the system gives no more. `run` must not throw.
void run_on_own_threads(unsigned threads, std::size_t count, const std::function<void(std::size_t)>& run);

}  // namespace coppice::base_internal
