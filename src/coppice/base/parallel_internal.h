#pragma once

#include <cstddef>
#include <functional>

namespace coppice::base_internal {

/// Calls run(i) for every i in [0, count), on threads started for this call and the calling thread; on fewer
/// if the system refuses to create more. `run` must not throw.
void run_on_own_threads(unsigned threads, std::size_t count, const std::function<void(std::size_t)>& run);

}  // namespace coppice::base_internal
