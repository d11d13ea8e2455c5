#pragma once

#include <algorithm>
#include <cstddef>
#include <vector>

#include "coppice/cuda/exec/cuda_check.cuh"

namespace coppice::cuda {

/// Stack allocator for one kind of memory. After reset(), memory that the first round took in several blocks
/// is a single block, so that later equal rounds allocate no memory.
template <class Kind>
class Arena {
  public:
    Arena() = default;
    Arena(const Arena&) = delete;
    Arena& operator=(const Arena&) = delete;
    ~Arena() { release_all(); }

    /// Amount of memory taken; see rewind().
    struct Mark {
        std::size_t block = 0, used = 0, total = 0;
        friend bool operator==(const Mark&, const Mark&) = default;
    };

    /// Returns memory aligned to 256 bytes.
    std::byte* take(std::size_t bytes) {
        bytes = (bytes + kAlignment - 1) / kAlignment * kAlignment;
        while (at_.block < blocks_.size() && blocks_[at_.block].size - at_.used < bytes)
            at_ = {at_.block + 1, 0, at_.total};
        if (at_.block == blocks_.size()) add_block(bytes);
        std::byte* const out = blocks_[at_.block].begin + at_.used;
        at_.used += bytes;
        at_.total += bytes;
        greatest_ = std::max(greatest_, at_.total);
        return out;
    }
    Mark mark() const { return at_; }
    /// Releases memory taken since the mark; or, with a later mark, reserves the same memory again.
    void rewind(const Mark& mark) { at_ = mark; }
    /// Releases everything.
    void reset() {
        if (blocks_.size() > 1) {
            release_all();
            add_block(greatest_);
        }
        at_ = {};
        greatest_ = 0;
    }
    /// Ensures that the single block of an unused arena has at least this size.
    void reserve(std::size_t bytes) {
        if (size() >= bytes) return;
        release_all();
        add_block(bytes);
    }
    std::size_t size() const {  ///< [bytes] taken or not
        std::size_t sum = 0;
        for (const Block& block : blocks_) sum += block.size;
        return sum;
    }
    std::size_t largest() const { return greatest_; }  ///< [bytes] maximum taken at once since the last reset

  private:
    static constexpr std::size_t kAlignment = 256;
    static constexpr std::size_t kMin = std::size_t{1} << 20;

    struct Block {
        std::byte* begin;
        std::size_t size;
    };
    void release_all() {
        for (const Block& block : blocks_) Kind::release(block.begin);
        blocks_.clear();
        at_ = {};
    }
    void add_block(std::size_t bytes) {
        const std::size_t size = std::max(bytes, kMin);
        blocks_.push_back({Kind::allocate(size), size});
        at_ = {blocks_.size() - 1, 0, at_.total};
    }

    std::vector<Block> blocks_;
    Mark at_;
    std::size_t greatest_ = 0;
};

struct DeviceMemory {
    static std::byte* allocate(std::size_t bytes) {
        void* p = nullptr;
        check(cudaMalloc(&p, bytes), "allocate memory");
        return static_cast<std::byte*>(p);
    }
    static void release(std::byte* p) { cudaFree(p); }
};

/// Host memory that the GPU can access at the full speed of the bus while kernels run.
struct PinnedMemory {
    static std::byte* allocate(std::size_t bytes) {
        void* p = nullptr;
        check(cudaMallocHost(&p, bytes), "allocate pinned memory");
        return static_cast<std::byte*>(p);
    }
    static void release(std::byte* p) { cudaFreeHost(p); }
};

}  // namespace coppice::cuda
