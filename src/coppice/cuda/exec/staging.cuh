#pragma once

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstring>

#include "coppice/cuda/exec/arena.cuh"

namespace coppice::cuda {

/// Pinned memory for asynchronous copies between a GPU and pageable host memory. Its two halves alternate, so
/// that one is filled while the other is emptied. Its size does not depend on the size of the copies.
class Staging {
  public:
    /// The stream must outlive this object.
    explicit Staging(cudaStream_t stream) : stream_(stream) {}
    Staging(const Staging&) = delete;
    Staging& operator=(const Staging&) = delete;
    ~Staging() {
        for (const Half& half : halves_) {
            if (half.begin != nullptr) PinnedMemory::release(half.begin);
            if (half.is_free != nullptr) cudaEventDestroy(half.is_free);
        }
    }

    /// Copies to the GPU, in the order of the stream; `from` may be freed immediately.
    void send(const std::byte* from, std::byte* to, std::size_t bytes) {
        begin();
        while (bytes > 0) {
            if (used_ == kHalf) take_turns();
            const std::size_t count = std::min(bytes, kHalf - used_);
            std::byte* const staged = halves_[now_].begin + used_;
            std::memcpy(staged, from, count);
            check(cudaMemcpyAsync(to, staged, count, cudaMemcpyHostToDevice, stream_),
                  "copy data from the host");
            used_ += count;
            from += count;
            to += count;
            bytes -= count;
        }
    }

    /// Copies from the GPU, and waits for completion.
    void bring(const std::byte* from, std::byte* to, std::size_t bytes) {
        if (bytes == 0) return;
        begin();
        const auto size = [&](std::size_t chunk) { return std::min(kHalf, bytes - chunk * kHalf); };
        const std::size_t chunks = (bytes + kHalf - 1) / kHalf;
        for (std::size_t k = 0; k <= chunks; ++k) {
            if (k < chunks) {
                const Half& half = halves_[k % 2];
                check(cudaMemcpyAsync(half.begin, from + k * kHalf, size(k), cudaMemcpyDeviceToHost, stream_),
                      "copy data to the host");
                check(cudaEventRecord(half.is_free, stream_), "record a copy");
            }
            if (k == 0) continue;
            const Half& before = halves_[(k - 1) % 2];
            check(cudaEventSynchronize(before.is_free), "copy data to the host");
            std::memcpy(to + (k - 1) * kHalf, before.begin, size(k - 1));
        }
        used_ = 0;  // all data sent before has arrived
    }

  private:
    static constexpr std::size_t kHalf = std::size_t{4} << 20;

    struct Half {
        std::byte* begin = nullptr;
        cudaEvent_t is_free = nullptr;  // set after the last copies from this half
    };

    void begin() {
        if (halves_[1].is_free != nullptr) return;
        for (Half& half : halves_) {
            half.begin = PinnedMemory::allocate(kHalf);
            check(cudaEventCreateWithFlags(&half.is_free, cudaEventDisableTiming), "create an event");
        }
    }
    void take_turns() {
        check(cudaEventRecord(halves_[now_].is_free, stream_), "record a copy");
        now_ = 1 - now_;
        used_ = 0;
        check(cudaEventSynchronize(halves_[now_].is_free), "copy data from the host");
    }

    cudaStream_t stream_;
    std::array<Half, 2> halves_;
    std::size_t now_ = 0, used_ = 0;  // index of the half that is being filled, and its fill level
};

}  // namespace coppice::cuda
