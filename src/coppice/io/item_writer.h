#pragma once

#include <algorithm>
#include <bit>
#include <charconv>
#include <cstring>
#include <string_view>
#include <vector>

#include "coppice/base/column.h"
#include "coppice/base/context.h"
#include "coppice/base/parallel.h"
#include "coppice/base/vec.h"
#include "coppice/system/file.h"

namespace coppice::io_internal {

static_assert(std::endian::native == std::endian::little,
              "the binary formats are written in the byte order of the memory");

/// A growing byte buffer that does not initialize memory.
class Chunk {
  public:
    /// Reserves space for `size` bytes; the following calls of put must not exceed it.
    void reserve(std::size_t size) {
        if (bytes_.size() - used_ < size) bytes_.resize(std::max(2 * bytes_.size(), used_ + size));
    }
    void put(char c) { bytes_[used_++] = c; }
    void put(std::string_view text) { put_bytes(text.data(), text.size()); }
    template <class T>
    void put_raw(const T& value) {
        put_bytes(&value, sizeof value);
    }
    template <class Number>
    void put_number(Number value) {
        char* const begin = bytes_.data() + used_;
        used_ += static_cast<std::size_t>(std::to_chars(begin, begin + kNumber, value).ptr - begin);
    }
    template <class T>
    void put_vector(BasicVec3<T> v, std::string_view between) {
        put_number(v.x);
        put(between);
        put_number(v.y);
        put(between);
        put_number(v.z);
    }
    void clear() { used_ = 0; }
    std::string_view view() const { return {bytes_.data(), used_}; }

    static constexpr std::size_t kNumber = 32;  ///< bytes to reserve for a number as text

  private:
    void put_bytes(const void* from, std::size_t size) {
        std::memcpy(bytes_.data() + used_, from, size);
        used_ += size;
    }

    Buffer<char> bytes_;
    std::size_t used_ = 0;
};

/// Range of the progress that one section of a file covers.
struct ProgressRange {
    float begin = 0;
    float end = 1;
};

/// Writes items 0 .. count: fill(i, chunk) appends item i. Runs of items of a fixed size are formatted in
/// parallel, a few at a time, and written in order.
template <class Fill>
void write_items(AtomicFile& file, std::size_t count, ProgressRange part, const Context& ctx,
                 const Fill& fill) {
    constexpr std::size_t kRun = 8192;
    constexpr std::size_t kRunsAtOnce = 32;
    std::vector<Chunk> chunks(std::min(kRunsAtOnce, (count + kRun - 1) / kRun));
    for (std::size_t begin = 0; begin < count; begin += kRun * kRunsAtOnce) {
        ctx.throw_if_cancelled();
        ctx.report(part.begin +
                   (part.end - part.begin) * static_cast<float>(begin) / static_cast<float>(count));
        const std::size_t wave = std::min(count - begin, kRun * kRunsAtOnce);
        parallel_for_ranges(ctx, wave, kRun, [&](IndexRange range) {
            Chunk& chunk = chunks[range.begin / kRun];
            chunk.clear();
            for (std::size_t i = range.begin; i < range.end; ++i) fill(begin + i, chunk);
        });
        for (std::size_t i = 0; i * kRun < wave; ++i) file.write(chunks[i].view());
    }
}

}  // namespace coppice::io_internal
