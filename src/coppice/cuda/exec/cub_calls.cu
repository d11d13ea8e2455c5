#include "coppice/cuda/exec/cub_calls.cuh"

#include <cub/device/device_radix_sort.cuh>
#include <cub/device/device_scan.cuh>

namespace coppice::cuda {

template <class T>
cudaError_t exclusive_sum(void* scratch, std::size_t& bytes, const T* in, T* out, int count,
                          cudaStream_t stream) {
    return cub::DeviceScan::ExclusiveSum(scratch, bytes, in, out, count, stream);
}

template <class Key>
cudaError_t radix_sort(void* scratch, std::size_t& bytes, TwoArrays<Key>& keys,
                       TwoArrays<std::uint32_t>& values, int count, int bits, cudaStream_t stream) {
    cub::DoubleBuffer<Key> key(keys.current, keys.other);
    cub::DoubleBuffer<std::uint32_t> value(values.current, values.other);
    const cudaError_t error =
        cub::DeviceRadixSort::SortPairs(scratch, bytes, key, value, count, 0, bits, stream);
    keys = {key.Current(), key.Alternate()};
    values = {value.Current(), value.Alternate()};
    return error;
}

template cudaError_t exclusive_sum(void*, std::size_t&, const std::uint32_t*, std::uint32_t*, int,
                                   cudaStream_t);
template cudaError_t exclusive_sum(void*, std::size_t&, const std::uint64_t*, std::uint64_t*, int,
                                   cudaStream_t);
template cudaError_t radix_sort(void*, std::size_t&, TwoArrays<std::uint32_t>&, TwoArrays<std::uint32_t>&,
                                int, int, cudaStream_t);
template cudaError_t radix_sort(void*, std::size_t&, TwoArrays<std::uint64_t>&, TwoArrays<std::uint32_t>&,
                                int, int, cudaStream_t);

}  // namespace coppice::cuda
