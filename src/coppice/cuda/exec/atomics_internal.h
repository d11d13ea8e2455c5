#pragma once

#include <atomic>
#include <cstdint>

#include "coppice/base/kernel/host_device.h"

namespace coppice::cuda {

/// Atomically adds to a number and returns its previous value, for example to reserve a unique index.
/// Integers only, so that the sum does not depend on the order.
template <class T>
COPPICE_HOST_DEVICE T add_to(T& sum, T value) {
#ifdef __CUDA_ARCH__
    return atomicAdd(&sum, value);
#else
    return std::atomic_ref(sum).fetch_add(value, std::memory_order_relaxed);
#endif
}

/// Atomically raises a number to at least `value`.
template <class T>
COPPICE_HOST_DEVICE void raise_to(T& largest, T value) {
#ifdef __CUDA_ARCH__
    atomicMax(&largest, value);
#else
    const std::atomic_ref shared(largest);
    T seen = shared.load(std::memory_order_relaxed);
    while (seen < value && !shared.compare_exchange_weak(seen, value, std::memory_order_relaxed)) {
    }
#endif
}

/// Atomically lowers a number to at most `value`.
template <class T>
COPPICE_HOST_DEVICE void lower_to(T& least, T value) {
#ifdef __CUDA_ARCH__
    static_assert(sizeof(T) == 4 || sizeof(T) == sizeof(unsigned long long));
    if constexpr (sizeof(T) == 4) {
        atomicMin(&least, value);
    } else {
        atomicMin(reinterpret_cast<unsigned long long*>(&least), static_cast<unsigned long long>(value));
    }
#else
    const std::atomic_ref shared(least);
    T seen = shared.load(std::memory_order_relaxed);
    while (seen > value && !shared.compare_exchange_weak(seen, value, std::memory_order_relaxed)) {
    }
#endif
}

/// Atomically replaces a number if it equals `expected`; returns its previous value.
COPPICE_HOST_DEVICE inline std::uint32_t replace(std::uint32_t& number, std::uint32_t expected,
                                                 std::uint32_t value) {
#ifdef __CUDA_ARCH__
    return atomicCAS(&number, expected, value);
#else
    std::atomic_ref(number).compare_exchange_strong(expected, value, std::memory_order_relaxed);
    return expected;
#endif
}

/// Returns the current or an earlier value of a number that other threads change.
COPPICE_HOST_DEVICE inline std::uint32_t peek(const std::uint32_t& number) {
#ifdef __CUDA_ARCH__
    return *static_cast<const volatile std::uint32_t*>(&number);
#else
    return std::atomic_ref(const_cast<std::uint32_t&>(number)).load(std::memory_order_relaxed);
#endif
}

/// Atomically sets bits of a word.
COPPICE_HOST_DEVICE inline void set_bits(std::uint64_t& word, std::uint64_t bits) {
#ifdef __CUDA_ARCH__
    static_assert(sizeof(unsigned long long) == sizeof word);
    atomicOr(reinterpret_cast<unsigned long long*>(&word), bits);
#else
    std::atomic_ref(word).fetch_or(bits, std::memory_order_relaxed);
#endif
}

/// Atomically sets bits of a 32-bit word; returns its previous value.
COPPICE_HOST_DEVICE inline std::uint32_t set_bits(std::uint32_t& word, std::uint32_t bits) {
#ifdef __CUDA_ARCH__
    return atomicOr(&word, bits);
#else
    return std::atomic_ref(word).fetch_or(bits, std::memory_order_relaxed);
#endif
}

/// Atomically clears bits of a word.
COPPICE_HOST_DEVICE inline void reset_bits(std::uint64_t& word, std::uint64_t bits) {
#ifdef __CUDA_ARCH__
    atomicAnd(reinterpret_cast<unsigned long long*>(&word), static_cast<unsigned long long>(~bits));
#else
    std::atomic_ref(word).fetch_and(~bits, std::memory_order_relaxed);
#endif
}

}  // namespace coppice::cuda
