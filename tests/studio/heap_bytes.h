#pragma once

#include <malloc.h>

#include <cstdint>

namespace coppice::test {

/// Returns the bytes that the program currently has allocated; 0 if a sanitizer replaces the heap.
inline std::uint64_t heap_bytes() {
    const auto info = ::mallinfo2();
    return info.uordblks + info.hblkhd;
}

}  // namespace coppice::test
