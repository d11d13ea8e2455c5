#pragma once

#include <algorithm>
#include <cstddef>
#include <vector>

#include "coppice/cuda/exec/cuda_check.cuh"

namespace coppice::cuda {

/// Memory of one kind that is handed out from the front and given back all at once. What a first round took
/// in several pieces is one piece from then on, so that rounds alike allocate nothing.
template <class Kind>
class Arena {
  public:
    Arena() = default;
    Arena(const Arena&) = delete;
    Arena& operator=(const Arena&) = delete;
    ~Arena() {
        for (const Piece& piece : pieces_) Kind::release(piece.begin);
    }

    /// Memory that begins at a multiple of 256 bytes.
    std::byte* take(std::size_t bytes) {
        bytes = (bytes + kAlignment - 1) / kAlignment * kAlignment;
        if (pieces_.empty() || pieces_.back().size - used_ < bytes) add_piece(bytes);
        std::byte* const out = pieces_.back().begin + used_;
        used_ += bytes;
        total_ += bytes;
        return out;
    }
    void reset() {
        if (pieces_.size() > 1) {
            for (const Piece& piece : pieces_) Kind::release(piece.begin);
            pieces_.clear();
            used_ = 0;
            add_piece(total_);
        }
        used_ = total_ = 0;
    }
    std::size_t used() const { return total_; }  ///< [bytes] since the last reset

  private:
    static constexpr std::size_t kAlignment = 256;
    static constexpr std::size_t kLeast = std::size_t{1} << 20;

    struct Piece {
        std::byte* begin;
        std::size_t size;
    };
    void add_piece(std::size_t bytes) {
        const std::size_t size = std::max(bytes, kLeast);
        pieces_.push_back({Kind::allocate(size), size});
        used_ = 0;
    }

    std::vector<Piece> pieces_;
    std::size_t used_ = 0;   // of the last piece
    std::size_t total_ = 0;  // of all
};

struct DeviceMemory {
    static std::byte* allocate(std::size_t bytes) {
        void* p = nullptr;
        check(cudaMalloc(&p, bytes), "allocate memory");
        return static_cast<std::byte*>(p);
    }
    static void release(std::byte* p) { cudaFree(p); }
};

/// Of the host, that the card reads and writes at the full speed of the bus, while kernels run.
struct PinnedMemory {
    static std::byte* allocate(std::size_t bytes) {
        void* p = nullptr;
        check(cudaMallocHost(&p, bytes), "allocate pinned memory");
        return static_cast<std::byte*>(p);
    }
    static void release(std::byte* p) { cudaFreeHost(p); }
};

}  // namespace coppice::cuda
