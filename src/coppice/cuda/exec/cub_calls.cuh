#pragma once

#include <cuda_runtime.h>

#include <cstddef>
#include <cstdint>

namespace coppice::cuda {

// Wrappers of CUB for 32 and 64 bits, compiled once, because compiling its headers takes longer than all of
// our code. Each requires scratch memory; with nullptr it only computes the number of bytes.

/// Computes the sum of all numbers before each number; `in` and `out` may be the same.
template <class T>
cudaError_t exclusive_sum(void* scratch, std::size_t& bytes, const T* in, T* out, int count,
                          cudaStream_t stream);

/// An array and a second one of equal size, for sorting in alternation.
template <class T>
struct TwoArrays {
    T* current;
    T* other;
};

/// Sorts stably by the lowest `bits` of the keys; the result is in `current`.
template <class Key>
cudaError_t radix_sort(void* scratch, std::size_t& bytes, TwoArrays<Key>& keys,
                       TwoArrays<std::uint32_t>& values, int count, int bits, cudaStream_t stream);

}  // namespace coppice::cuda
