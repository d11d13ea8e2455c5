#pragma once

#include <atomic>

#include "coppice/base/host_device.h"

namespace coppice::cuda {

/// Adds to a number that others add to as well. Whole numbers only: of these the sum does not depend on the
/// order.
template <class T>
COPPICE_HOST_DEVICE void add_to(T& sum, T value) {
#ifdef __CUDA_ARCH__
    atomicAdd(&sum, value);
#else
    std::atomic_ref(sum).fetch_add(value, std::memory_order_relaxed);
#endif
}

/// Makes a number that others raise as well at least `value`.
template <class T>
COPPICE_HOST_DEVICE void raise_to(T& greatest, T value) {
#ifdef __CUDA_ARCH__
    atomicMax(&greatest, value);
#else
    const std::atomic_ref shared(greatest);
    T seen = shared.load(std::memory_order_relaxed);
    while (seen < value && !shared.compare_exchange_weak(seen, value, std::memory_order_relaxed)) {
    }
#endif
}

}  // namespace coppice::cuda
