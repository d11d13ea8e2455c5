#pragma once

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstring>

#include "coppice/cuda/exec/arena.cuh"

namespace coppice::cuda {

/// Pinned memory that copies between a card and any memory of the host go through, which otherwise would wait
/// for each other: its two halves take turns, so that one is filled while the other is emptied. However much
/// is copied, it stays as small as that.
class Staging {
  public:
    /// The stream must outlive it.
    explicit Staging(cudaStream_t stream) : stream_(stream) {}
    Staging(const Staging&) = delete;
    Staging& operator=(const Staging&) = delete;
    ~Staging() {
        for (const Half& half : halves_) {
            if (half.begin != nullptr) PinnedMemory::release(half.begin);
            if (half.is_free != nullptr) cudaEventDestroy(half.is_free);
        }
    }

    /// Copies to the card, in the order of the stream; `from` may go away at once.
    void send(const std::byte* from, std::byte* to, std::size_t bytes) {
        begin();
        while (bytes > 0) {
            if (used_ == kHalf) take_turns();
            const std::size_t count = std::min(bytes, kHalf - used_);
            std::byte* const staged = halves_[now_].begin + used_;
            std::memcpy(staged, from, count);
            check(cudaMemcpyAsync(to, staged, count, cudaMemcpyHostToDevice, stream_), "take data");
            used_ += count;
            from += count;
            to += count;
            bytes -= count;
        }
    }

    /// Copies from the card, and waits for it.
    void bring(const std::byte* from, std::byte* to, std::size_t bytes) {
        if (bytes == 0) return;
        begin();
        const auto size = [&](std::size_t chunk) { return std::min(kHalf, bytes - chunk * kHalf); };
        const std::size_t chunks = (bytes + kHalf - 1) / kHalf;
        for (std::size_t k = 0; k <= chunks; ++k) {
            if (k < chunks) {
                const Half& half = halves_[k % 2];
                check(cudaMemcpyAsync(half.begin, from + k * kHalf, size(k), cudaMemcpyDeviceToHost, stream_),
                      "give data back");
                check(cudaEventRecord(half.is_free, stream_), "note a copy");
            }
            if (k == 0) continue;
            const Half& before = halves_[(k - 1) % 2];
            check(cudaEventSynchronize(before.is_free), "give data back");
            std::memcpy(to + (k - 1) * kHalf, before.begin, size(k - 1));
        }
        used_ = 0;  // all that was sent before has arrived
    }

  private:
    static constexpr std::size_t kHalf = std::size_t{4} << 20;

    struct Half {
        std::byte* begin = nullptr;
        cudaEvent_t is_free = nullptr;  // the copies that it was left with have been made
    };

    void begin() {
        if (halves_[1].is_free != nullptr) return;
        for (Half& half : halves_) {
            half.begin = PinnedMemory::allocate(kHalf);
            check(cudaEventCreateWithFlags(&half.is_free, cudaEventDisableTiming), "make an event");
        }
    }
    void take_turns() {
        check(cudaEventRecord(halves_[now_].is_free, stream_), "note a copy");
        now_ = 1 - now_;
        used_ = 0;
        check(cudaEventSynchronize(halves_[now_].is_free), "take data");
    }

    cudaStream_t stream_;
    std::array<Half, 2> halves_;
    std::size_t now_ = 0, used_ = 0;  // the half that is being filled, and how far it is
};

}  // namespace coppice::cuda
