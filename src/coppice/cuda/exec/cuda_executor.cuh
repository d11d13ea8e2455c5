#pragma once

#include <algorithm>
#include <chrono>
#include <cstdint>
#include <limits>
#include <span>
#include <type_traits>
#include <vector>

#include "coppice/base/context.h"
#include "coppice/base/kernel/host_device.h"
#include "coppice/cuda/exec/arena.cuh"
#include "coppice/cuda/exec/cub_calls.cuh"
#include "coppice/cuda/exec/kernel_time.h"
#include "coppice/cuda/exec/recording.cuh"
#include "coppice/cuda/exec/staging.cuh"

namespace coppice::cuda {

inline constexpr std::uint32_t kThreads = 128;  ///< per block
/// Threads per block of a kernel that defines kIsWide.
inline constexpr std::uint32_t kWideThreads = 512;

template <class Kernel>
constexpr std::uint32_t count_threads() {
    if constexpr (requires { Kernel::kIsWide; }) return kWideThreads;
    return kThreads;
}

/// See HostGroup. Its members are also marked for the host because kernels are, but are empty there.
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
        __shared__ std::uint32_t of_warp[kWideThreads / 32];
        const std::uint32_t warps = blockDim.x / 32, warp = threadIdx.x / 32, lane = threadIdx.x % 32;
        for (std::uint32_t begin = 0; begin < count; begin += blockDim.x) {
            const std::uint32_t i = begin + threadIdx.x;
            const bool is_one = i < count && test(i);
            const std::uint32_t votes = __ballot_sync(0xffffffffu, is_one);
            if (lane == 0) of_warp[warp] = __popc(votes);
            __syncthreads();
            std::uint32_t before = found;
            for (std::uint32_t w = 0; w < warps; ++w) {
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

// Kernels are grid constants: if a thread indexes an array in the kernel by a computed value, the compiler
// could otherwise create a copy in local memory for each thread.
template <class Kernel>
__global__ void __launch_bounds__(kThreads)
    run_each(std::uint32_t count, const __grid_constant__ Kernel kernel) {
    const std::uint32_t i = blockIdx.x * blockDim.x + threadIdx.x;
    if (i < count) kernel(i);
}

template <class Kernel>
__global__ void __launch_bounds__(count_threads<Kernel>()) run_groups(const __grid_constant__ Kernel kernel) {
    kernel(blockIdx.x, CudaGroup());
}

/// Runs kernels on a GPU, in one stream: see HostExecutor for the members. Arrays are parts of one block of
/// memory that is kept between rounds; copies use pinned memory and are asynchronous. Throws DeviceError.
class CudaExecutor {
  public:
    static constexpr bool kIsDevice = true;

    /// Memory taken so far; see rewind().
    struct Mark {
        Arena<DeviceMemory>::Mark device;
        Arena<PinnedMemory>::Mark pinned;
        friend bool operator==(const Mark&, const Mark&) = default;
    };

    /// See replay().
    class Recording {
      public:
        void clear() {
            graph_.clear();
            times_ = 0;
        }

      private:
        friend CudaExecutor;
        Graph graph_;
        int times_ = 0;  // number of calls without the recording
        Mark begin_, end_;
    };

    /// Arrays may use up to `most` bytes of the GPU.
    explicit CudaExecutor(const Context& ctx = {}, std::size_t most = std::numeric_limits<std::size_t>::max())
        : ctx_(ctx), most_(most), stream_(new_stream()), staging_(stream_) {}
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

    /// Selects the GPU with this CUDA number for this thread.
    static void choose(int device) { check(cudaSetDevice(device), "be selected"); }

    std::size_t room() const {
        std::size_t free = 0, all = 0;
        check(cudaMemGetInfo(&free, &all), "report its memory");
        return std::min(most_, free - free / 32 + device_.size());  // the driver requires some of it
    }
    /// Ensures that this amount of memory is available as one block; throws if the GPU has less. Memory
    /// beyond it is allocated in further blocks.
    void reserve(std::size_t bytes) {
        require_room(room(), bytes);
        device_.reserve(bytes);
    }
    template <class T>
    std::span<T> array(std::size_t count) {
        static_assert(std::is_trivially_copyable_v<T>);
        const std::size_t bytes = count * sizeof(T);
        require_room(most_, device_.mark().total + bytes);
        return {reinterpret_cast<T*>(device_.take(bytes)), count};
    }
    template <class T>
    std::span<const T> upload(std::span<const T> values) {
        const std::span<T> out = array<T>(values.size());
        write(values, out);
        return out;
    }
    template <class T>
    void write(std::span<const T> from, std::span<T> to) {
        staging_.send(to_bytes(from), reinterpret_cast<std::byte*>(to.data()), from.size_bytes());
    }
    template <class T>
    void download(std::span<const T> from, std::span<T> to) {
        staging_.bring(to_bytes(from), reinterpret_cast<std::byte*>(to.data()), from.size_bytes());
        wait();
    }
    template <class T>
    std::span<const T> fetch(std::span<const T> from) {
        T* const to = reinterpret_cast<T*>(pinned_.take(from.size_bytes()));
        check(cudaMemcpyAsync(to, from.data(), from.size_bytes(), cudaMemcpyDeviceToHost, stream_),
              "copy data to the host");
        return {to, from.size()};
    }
    template <class T>
    void clear(std::span<T> values) {
        if (values.empty()) return;
        check(cudaMemsetAsync(values.data(), 0, values.size_bytes(), stream_), "clear memory");
    }
    Mark mark() const { return {device_.mark(), pinned_.mark()}; }
    /// Does not wait: later users of the same memory come later in the stream.
    void rewind(const Mark& mark) {
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
        static_assert(sizeof(Kernel) <= kMaxOfKernel);
        if (count == 0) return;
        const auto threads = checked<std::uint32_t>(count);
        launch(name, [&] {
            const auto blocks = static_cast<std::uint32_t>((count + kThreads - 1) / kThreads);
            run_each<<<blocks, kThreads, 0, stream_>>>(threads, kernel);
        });
    }
    template <class Kernel>
    void groups(const char* name, std::size_t count, const Kernel& kernel) {
        static_assert(sizeof(Kernel) <= kMaxOfKernel);
        if (count == 0) return;
        const auto blocks = static_cast<std::uint32_t>(checked<int>(count));
        launch(name, [&] { run_groups<<<blocks, count_threads<Kernel>(), 0, stream_>>>(kernel); });
    }
    template <class T>
    void exclusive_scan(std::span<const T> counts, std::span<T> out) {
        if (counts.empty()) return;
        const int size = checked<int>(counts.size());
        launch("scan", [&] {
            with_scratch([&](void* scratch, std::size_t& bytes) {
                return exclusive_sum(scratch, bytes, counts.data(), out.data(), size, stream_);
            });
        });
    }
    template <class Key>
    void sort_pairs(std::span<Key> keys, std::span<std::uint32_t> values, int bits = 8 * sizeof(Key)) {
        if (keys.empty()) return;
        const int size = checked<int>(keys.size());
        TwoArrays<Key> key{keys.data(), array<Key>(keys.size()).data()};
        TwoArrays<std::uint32_t> value{values.data(), array<std::uint32_t>(values.size()).data()};
        launch("sort", [&] {
            with_scratch([&](void* scratch, std::size_t& bytes) {
                return radix_sort(scratch, bytes, key, value, size, bits, stream_);
            });
        });
        copy_within(key.current, keys);
        copy_within(value.current, values);
    }
    template <class Work>
    void replay(Recording& recording, const Work& work) {
        if (measures_) return work();  // one launch at a time
        const Mark begin = mark();
        if (recording.graph_.has_launches() && recording.begin_ == begin) {
            recording.graph_.launch(stream_);
            return rewind(recording.end_);
        }
        // The first call allocates memory and loads kernels, which cannot be recorded.
        if (recording.times_++ != 1 || !recording.graph_.record(stream_, work)) {
            rewind(begin);
            return work();
        }
        recording.begin_ = begin;
        recording.end_ = mark();
        recording.graph_.launch(stream_);
    }
    void wait() { check(cudaStreamSynchronize(stream_), "finish"); }

    cudaStream_t stream() const { return stream_; }
    std::size_t bytes_used() const { return device_.largest(); }  ///< memory of the GPU, since the last reset

    /// Enables recording of the time of every launch.
    void measure() { measures_ = true; }
    /// Returns the times recorded since the last call, one per launch.
    std::vector<KernelTime> take_times() {
        wait();
        std::vector<KernelTime> out;
        for (const Timed& t : timed_) {
            float milliseconds = 0;
            check(cudaEventElapsedTime(&milliseconds, t.begin, t.end), "report the time");
            out.push_back({t.name, 1e-3 * milliseconds});
            cudaEventDestroy(t.begin);
            cudaEventDestroy(t.end);
        }
        timed_.clear();
        return out;
    }

  private:
    // [bytes] maximum kernel arguments for capability 7.5 and CUDA 12.0.
    static constexpr std::size_t kMaxOfKernel = 4000;
    template <class T>
    static const std::byte* to_bytes(std::span<const T> values) {
        return reinterpret_cast<const std::byte*>(values.data());
    }
    static cudaStream_t new_stream() {
        cudaStream_t stream = nullptr;
        check(cudaStreamCreateWithFlags(&stream, cudaStreamNonBlocking), "create a stream");
        return stream;
    }

    struct Timed {
        const char* name;
        cudaEvent_t begin, end;
    };

    template <class Int>
    static Int checked(std::size_t count) {
        if (count > static_cast<std::size_t>(std::numeric_limits<Int>::max()))
            throw DeviceFull("the work exceeds the limits of a CUDA device");
        return static_cast<Int>(count);
    }

    cudaEvent_t note_time() {
        cudaEvent_t event = nullptr;
        check(cudaEventCreate(&event), "create an event");
        check(cudaEventRecord(event, stream_), "record the time");
        return event;
    }
    template <class Begin>
    void launch(const char* name, const Begin& begin) {
        ctx_.throw_if_cancelled();
        const cudaEvent_t before = measures_ ? note_time() : nullptr;
        begin();
        check(cudaGetLastError(), name);
        if (measures_) timed_.push_back({name, before, note_time()});
    }
    template <class Call>
    void with_scratch(const Call& call) {
        std::size_t bytes = 0;
        check(call(nullptr, bytes), "compute the size of its scratch memory");
        check(call(array<std::byte>(bytes).data(), bytes), "run");
    }
    template <class T>
    void copy_within(const T* from, std::span<T> to) {
        if (from == to.data()) return;
        check(cudaMemcpyAsync(to.data(), from, to.size_bytes(), cudaMemcpyDeviceToDevice, stream_), "copy");
    }

    Context ctx_;
    std::size_t most_;
    cudaStream_t stream_ = nullptr;
    Staging staging_;
    Arena<DeviceMemory> device_;
    Arena<PinnedMemory> pinned_;
    bool measures_ = false;
    std::vector<Timed> timed_;
};

}  // namespace coppice::cuda
