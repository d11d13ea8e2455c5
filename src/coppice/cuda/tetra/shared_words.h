#pragma once

#include <atomic>
#include <cstdint>

#include "coppice/base/host_device.h"

namespace coppice::cuda {

/// Sets bits of a word in which others set some as well.
COPPICE_HOST_DEVICE inline void set_bits(std::uint64_t& word, std::uint64_t bits) {
#ifdef __CUDA_ARCH__
    static_assert(sizeof(unsigned long long) == sizeof word);
    atomicOr(reinterpret_cast<unsigned long long*>(&word), bits);
#else
    std::atomic_ref(word).fetch_or(bits, std::memory_order_relaxed);
#endif
}

/// A place of one's own among those that others take as well, in any order; counts them.
COPPICE_HOST_DEVICE inline std::uint32_t take_place(std::uint32_t& count) {
#ifdef __CUDA_ARCH__
    return atomicAdd(&count, 1u);
#else
    return std::atomic_ref(count).fetch_add(1, std::memory_order_relaxed);
#endif
}

}  // namespace coppice::cuda
