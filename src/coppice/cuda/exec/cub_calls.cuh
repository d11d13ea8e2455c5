#pragma once

#include <cuda_runtime.h>

#include <cstddef>
#include <cstdint>

namespace coppice::cuda {

// CUB's calls, for 32 and 64 bits, compiled once: reading its headers takes longer than all of ours. Each
// wants scratch memory, and without any (nullptr) only tells how many bytes.

/// What stands before each number, summed up; `in` and `out` may be the same.
template <class T>
cudaError_t exclusive_sum(void* scratch, std::size_t& bytes, const T* in, T* out, int count,
                          cudaStream_t stream);

/// An array and a second one, between which what is sorted goes to and fro.
template <class T>
struct TwoArrays {
    T* current;
    T* other;
};

/// Sorts stably by the lowest `bits` of the keys; what is sorted is `current` then.
template <class Key>
cudaError_t radix_sort(void* scratch, std::size_t& bytes, TwoArrays<Key>& keys,
                       TwoArrays<std::uint32_t>& values, int count, int bits, cudaStream_t stream);

}  // namespace coppice::cuda
