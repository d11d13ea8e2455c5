#pragma once

#include <cub/device/device_radix_sort.cuh>
#include <cub/device/device_scan.cuh>

#include <chrono>
#include <cstdint>
#include <cstring>
#include <span>
#include <string>
#include <type_traits>
#include <vector>

#include "coppice/base/context.h"
#include "coppice/base/kernel/host_device.h"
#include "coppice/cuda/exec/arena.cuh"
#include "coppice/cuda/exec/kernel_time.h"

namespace coppice::cuda {

inline constexpr std::uint32_t kThreads = 128;  ///< of a block

/// See HostGroup. Its members are marked for the host as well since kernels are, but do nothing there.
class CudaGroup {
  public:
    template <class Body>
    COPPICE_HOST_DEVICE void each(std::uint32_t count, const Body& body) const {
#ifdef __CUDA_ARCH__
        for (std::uint32_t i = threadIdx.x; i < count; i += blockDim.x) body(i);
        __syncthreads();
#endif
    }
    template <class Test>
    COPPICE_HOST_DEVICE std::uint32_t select(std::uint32_t count, const Test& test,
                                             std::uint32_t* out) const {
        std::uint32_t found = 0;
#ifdef __CUDA_ARCH__
        constexpr std::uint32_t kWarps = kThreads / 32;
        __shared__ std::uint32_t of_warp[kWarps];
        const std::uint32_t warp = threadIdx.x / 32, lane = threadIdx.x % 32;
        for (std::uint32_t begin = 0; begin < count; begin += kThreads) {
            const std::uint32_t i = begin + threadIdx.x;
            const bool is_one = i < count && test(i);
            const std::uint32_t votes = __ballot_sync(0xffffffffu, is_one);
            if (lane == 0) of_warp[warp] = __popc(votes);
            __syncthreads();
            std::uint32_t before = found;
            for (std::uint32_t w = 0; w < kWarps; ++w) {
                if (w < warp) before += of_warp[w];
                found += of_warp[w];
            }
            if (is_one) out[before + __popc(votes & ((1u << lane) - 1))] = i;
            __syncthreads();
        }
#endif
        return found;
    }
};

template <class Kernel>
__global__ void __launch_bounds__(kThreads) run_each(std::uint32_t count, Kernel kernel) {
    const std::uint32_t i = blockIdx.x * blockDim.x + threadIdx.x;
    if (i < count) kernel(i);
}

template <class Kernel>
__global__ void __launch_bounds__(kThreads) run_groups(Kernel kernel) {
    kernel(blockIdx.x, CudaGroup());
}

/// Runs kernels on a card, in one stream: see HostExecutor for the members. Arrays come from one piece of
/// memory that is kept from round to round; copies go through pinned memory and do not wait. Throws
/// DeviceError.
class CudaExecutor {
  public:
    static constexpr bool kIsDevice = true;

    explicit CudaExecutor(const Context& ctx = {}) : ctx_(ctx) {
        check(cudaStreamCreateWithFlags(&stream_, cudaStreamNonBlocking), "begin a stream");
    }
    CudaExecutor(const CudaExecutor&) = delete;
    CudaExecutor& operator=(const CudaExecutor&) = delete;
    ~CudaExecutor() {
        cudaStreamSynchronize(stream_);
        for (const Timed& t : timed_) {
            cudaEventDestroy(t.begin);
            cudaEventDestroy(t.end);
        }
        cudaStreamDestroy(stream_);
    }

    /// Makes sure of so much memory at once; throws when the card has less. What is taken beyond it comes in
    /// further pieces.
    void reserve(std::size_t bytes) {
        std::size_t free = 0, all = 0;
        check(cudaMemGetInfo(&free, &all), "tell its memory");
        if (bytes > free + device_.size()) {
            throw DeviceError("the CUDA device has " + std::to_string((free + device_.size()) >> 20) +
                              " MiB of memory free, and " + std::to_string(bytes >> 20) + " would be needed");
        }
        device_.reserve(bytes);
    }
    template <class T>
    std::span<T> array(std::size_t count) {
        static_assert(std::is_trivially_copyable_v<T>);
        return {reinterpret_cast<T*>(device_.take(count * sizeof(T))), count};
    }
    template <class T>
    std::span<const T> upload(std::span<const T> values) {
        const std::span<T> out = array<T>(values.size());
        write(values, out);
        return out;
    }
    template <class T>
    void write(std::span<const T> from, std::span<T> to) {
        if (from.empty()) return;
        std::byte* const staged = pinned_.take(from.size_bytes());
        std::memcpy(staged, from.data(), from.size_bytes());
        check(cudaMemcpyAsync(to.data(), staged, from.size_bytes(), cudaMemcpyHostToDevice, stream_),
              "take data");
    }
    template <class T>
    void download(std::span<const T> from, std::span<T> to) {
        if (!from.empty()) {
            check(cudaMemcpyAsync(to.data(), from.data(), from.size_bytes(), cudaMemcpyDeviceToHost, stream_),
                  "give data back");
        }
        wait();
    }
    template <class T>
    void clear(std::span<T> values) {
        if (values.empty()) return;
        check(cudaMemsetAsync(values.data(), 0, values.size_bytes(), stream_), "clear memory");
    }
    /// What was taken so far; see rewind().
    struct Mark {
        Arena<DeviceMemory>::Mark device;
        Arena<PinnedMemory>::Mark pinned;
    };
    Mark mark() const { return {device_.mark(), pinned_.mark()}; }
    void rewind(const Mark& mark) {
        wait();
        device_.rewind(mark.device);
        pinned_.rewind(mark.pinned);
    }
    void reset() {
        wait();
        device_.reset();
        pinned_.reset();
    }

    template <class Kernel>
    void each(const char* name, std::size_t count, const Kernel& kernel) {
        if (count == 0) return;
        launch(name, [&] {
            const auto blocks = static_cast<std::uint32_t>((count + kThreads - 1) / kThreads);
            run_each<<<blocks, kThreads, 0, stream_>>>(static_cast<std::uint32_t>(count), kernel);
        });
    }
    template <class Kernel>
    void groups(const char* name, std::size_t count, const Kernel& kernel) {
        if (count == 0) return;
        launch(name,
               [&] { run_groups<<<static_cast<std::uint32_t>(count), kThreads, 0, stream_>>>(kernel); });
    }
    template <class T>
    void exclusive_scan(std::span<const T> counts, std::span<T> out) {
        if (counts.empty()) return;
        launch("scan", [&] {
            with_scratch([&](void* scratch, std::size_t& bytes) {
                return cub::DeviceScan::ExclusiveSum(scratch, bytes, counts.data(), out.data(),
                                                     static_cast<int>(counts.size()), stream_);
            });
        });
    }
    template <class Key>
    void sort_pairs(std::span<Key> keys, std::span<std::uint32_t> values, int bits = 8 * sizeof(Key)) {
        if (keys.empty()) return;
        cub::DoubleBuffer<Key> key(keys.data(), array<Key>(keys.size()).data());
        cub::DoubleBuffer<std::uint32_t> value(values.data(), array<std::uint32_t>(values.size()).data());
        launch("sort", [&] {
            with_scratch([&](void* scratch, std::size_t& bytes) {
                return cub::DeviceRadixSort::SortPairs(scratch, bytes, key, value,
                                                       static_cast<int>(keys.size()), 0, bits, stream_);
            });
        });
        copy_within(key.Current(), keys);
        copy_within(value.Current(), values);
    }
    void wait() { check(cudaStreamSynchronize(stream_), "finish"); }

    cudaStream_t stream() const { return stream_; }
    std::size_t bytes_used() const { return device_.greatest(); }  ///< of the card, since the last reset

    /// From now on the time of every launch is noted.
    void measure() { measures_ = true; }
    /// What was noted since it was asked for the last time, launch by launch.
    std::vector<KernelTime> take_times() {
        wait();
        std::vector<KernelTime> out;
        for (const Timed& t : timed_) {
            float milliseconds = 0;
            check(cudaEventElapsedTime(&milliseconds, t.begin, t.end), "tell the time");
            out.push_back({t.name, 1e-3 * milliseconds});
            cudaEventDestroy(t.begin);
            cudaEventDestroy(t.end);
        }
        timed_.clear();
        return out;
    }

  private:
    struct Timed {
        const char* name;
        cudaEvent_t begin, end;
    };

    template <class Begin>
    void launch(const char* name, const Begin& begin) {
        ctx_.throw_if_cancelled();
        Timed timed{name, nullptr, nullptr};
        if (measures_) {
            check(cudaEventCreate(&timed.begin), "make an event");
            check(cudaEventCreate(&timed.end), "make an event");
            timed_.push_back(timed);
            check(cudaEventRecord(timed.begin, stream_), "note the time");
        }
        begin();
        check(cudaGetLastError(), name);
        if (measures_) check(cudaEventRecord(timed.end, stream_), "note the time");
    }
    template <class Call>
    void with_scratch(const Call& call) {
        std::size_t bytes = 0;
        check(call(nullptr, bytes), "size its scratch memory");
        check(call(array<std::byte>(bytes).data(), bytes), "run");
    }
    template <class T>
    void copy_within(const T* from, std::span<T> to) {
        if (from == to.data()) return;
        check(cudaMemcpyAsync(to.data(), from, to.size_bytes(), cudaMemcpyDeviceToDevice, stream_), "copy");
    }

    Context ctx_;
    cudaStream_t stream_ = nullptr;
    Arena<DeviceMemory> device_;
    Arena<PinnedMemory> pinned_;
    bool measures_ = false;
    std::vector<Timed> timed_;
};

}  // namespace coppice::cuda
