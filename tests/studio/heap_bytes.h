#pragma once

#include <malloc.h>

#include <cstdint>

namespace coppice::test {

/// Bytes that the program has from the heap now; 0 where a sanitizer has a heap of its own.
inline std::uint64_t heap_bytes() {
    const auto info = ::mallinfo2();
    return info.uordblks + info.hblkhd;
}

}  // namespace coppice::test
